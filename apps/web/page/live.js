// Live: the events of a stream to scrolling traces, glitches, drift and losses.
import {byId, client, element, get, post, shown, table, unitText} from './common.js';
import {Strip} from './strip.js';

const KEPT = 60;  // seconds that this page remembers
let layout = null, id = -1, state = null, sampler = false;
let data = null;    // {t, low, high}: what has come
let paused = null;  // the time at which the picture stands
let strips = [], glitches = [], chosen = new Set();
let missed = 0, machine = null, told = 0, asking = false;

const say = (text) => { if (byId('summary').textContent !== text) byId('summary').textContent = text; };
const fail = (text) => {
  byId('problem').textContent = text || '';
  byId('problem').hidden = !text;
};
const um = (x) => shown(x, 3) + ' \u00b5m';

// ---- the stream

const begin = (message) => {
  id = message.id;
  layout = message.layout || null;
  state = null;
  paused = null;
  missed = 0;
  glitches = [];
  fail('');
  byId('pause').textContent = 'Pause';
  byId('pause').setAttribute('aria-pressed', 'false');
  data = layout && {t: [], low: layout.channels.map(() => []), high: layout.channels.map(() => [])};
  for (const part of ['stream', 'recording', 'traces']) byId(part).hidden = !layout;
  if (!layout) return;
  // At first errors and forces: what friction is seen by.
  const names = layout.channels.map((c) => c.name);
  const kept = names.filter((n) => chosen.has(n));
  const first = layout.channels.filter((c) => c.unit === 'um' || c.unit === 'N').map((c) => c.name);
  chosen = new Set(kept.length > 0 ? kept : (first.length > 0 ? first.filter((n) => !n.startsWith('friction')) : names.slice(0, 4)));
  byId('channels').replaceChildren(...layout.channels.map((c, i) => element('label', {class: 'check'},
      element('input', {type: 'checkbox', value: c.name, checked: chosen.has(c.name), onchange: (e) => {
        if (e.target.checked) chosen.add(c.name);
        else chosen.delete(c.name);
        makeStrips();
      }}), ` ${c.name}${c.unit ? ` [${unitText(c.unit)}]` : ''}`)));
  makeStrips();
};

const makeStrips = () => {
  byId('strips').replaceChildren();
  strips = [];
  const groups = new Map();
  layout.channels.forEach((c, i) => {
    if (!chosen.has(c.name)) return;
    const key = i === layout.error ? 'error' : c.unit;
    groups.set(key, [...(groups.get(key) || []), {label: c.name, channel: i}]);
  });
  const named = {um: 'Tracking error', N: 'Force', mm: 'Position', V: 'Voltage'};
  const order = [...groups.keys()].sort((a, b) => (b === 'error') - (a === 'error'));
  for (const key of order) {
    const traces = groups.get(key).map((t, i) => ({...t, look: i % 8}));
    const title = key === 'error' ? 'Contour error' : named[key] || (traces.length === 1 ? traces[0].label : key ? 'Channels' : 'Channels without a unit');
    const strip = new Strip(byId('strips'), title, unitText(key === 'error' ? 'um' : key));
    strip.isError = key === 'error';
    strip.set(traces);
    strips.push(strip);
  }
};

const take = (message) => {
  if (message.id !== id) begin(message);
  if (message.t && data) {
    missed += message.missed;
    data.t.push(...message.t);
    message.low.forEach((values, c) => data.low[c].push(...values));
    message.high.forEach((values, c) => data.high[c].push(...values));
    // While the picture stands, what it shows is kept.
    const oldest = data.t[data.t.length - 1] - KEPT;
    let n = 0;
    while (n < data.t.length && data.t[n] < oldest && (paused === null || data.t[n] < paused - KEPT)) ++n;
    n = Math.max(n, data.t.length - 4 * KEPT * 100);
    if (n > 500) for (const list of [data.t, ...data.low, ...data.high]) list.splice(0, n);
  }
  if (message.glitches) {
    glitches.push(...message.glitches);
    glitches.splice(0, Math.max(0, glitches.length - 200));
    if (paused === null) drawGlitches();
  }
  if (message.state !== undefined) {
    state = message.state;
    drawState();
  }
};

// ---- pictures

const now = () => paused ?? (data.t.length > 0 ? data.t[data.t.length - 1] : 0);
const draw = () => {
  requestAnimationFrame(draw);
  if (!layout || document.hidden) return;
  const window = Number(byId('window').value), end = now();
  const marks = glitches.filter((p) => p.t_s <= end && p.t_s >= end - window).map((p) => ({t: p.t_s, text: p.axis}));
  for (const strip of strips) strip.draw(data, end, window, 2.5 * layout.bin_ms / 1e3, strip.isError ? marks : []);
  if (performance.now() - told < 1000) return;
  told = performance.now();
  for (const strip of strips) strip.tell();
  if (paused === null) drawNow(end, window);
};

const drawNow = (end, window) => {
  const from = data.t.findIndex((t) => t >= end - window);
  const range = (c) => {
    let low = Infinity, high = -Infinity;
    for (let i = Math.max(0, from); i < data.t.length; ++i) {
      if (data.low[c][i] !== null && data.low[c][i] < low) low = data.low[c][i];
      if (data.high[c][i] !== null && data.high[c][i] > high) high = data.high[c][i];
    }
    return low <= high ? [low, high] : [null, null];
  };
  const parts = [];
  if (layout.error !== null) {
    const [low, high] = range(layout.error);
    parts.push(['Largest contour error', low === null ? '\u2013' : shown(Math.max(-low, high), 3), '\u00b5m', `of the last ${window} s`]);
  }
  for (const axis of layout.axes) {
    const last = glitches.findLast((p) => p.axis === axis);
    parts.push([`Quadrant glitch of ${axis}`, last ? shown(last.glitch_um, 3) : '\u2013', '\u00b5m', last ? `reversal to ${last.to === '+' ? '+' : '\u2212'}${axis}` : 'no reversal yet']);
  }
  byId('numbers').replaceChildren(...parts.map(([name, value, unit, remark]) => element('div', {}, element('dt', {text: name}),
      element('dd', {}, value, element('small', {text: ` ${unit}, ${remark}`})))));
  const rows = layout.channels.map((c, i) => [c, range(i)]).filter(([c]) => chosen.has(c.name))
      .map(([c, [low, high]]) => [c.name, shown(low, 4), shown(high, 4), unitText(c.unit)]);
  // A table that is being read is not replaced under the reader.
  if (!byId('now').contains(document.activeElement))
    byId('now').replaceChildren(table(`Smallest and largest values of the last ${window} s`, [{text: 'channel'}, {text: 'smallest', number: true}, {text: 'largest', number: true}, {text: 'unit'}], rows));
};

// Of each axis and direction the last glitch, and the mean and largest of those that this page has seen.
const drawGlitches = () => {
  const rows = [];
  for (const axis of layout.axes) {
    for (const to of ['+', '-']) {
      const all = glitches.filter((p) => p.axis === axis && p.to === to);
      if (all.length === 0) continue;
      const sizes = all.map((p) => Math.abs(p.glitch_um));
      rows.push([`${axis} reverses to ${to === '+' ? '+' : '\u2212'}${axis}`, shown(all[all.length - 1].glitch_um, 3),
        shown(sizes.reduce((a, b) => a + b) / sizes.length, 3), shown(Math.max(...sizes), 3), String(all.length)]);
    }
  }
  if (byId('glitches').contains(document.activeElement)) return;
  byId('glitches').replaceChildren(...(rows.length === 0 ? [] : [table('Quadrant glitches', [{text: 'quadrant'}, {text: 'last', unit: '\u00b5m', number: true},
    {text: 'mean size', unit: '\u00b5m', number: true}, {text: 'largest', unit: '\u00b5m', number: true}, {text: 'seen', number: true}], rows)]));
};

const drawState = () => {
  const running = state && !state.ended;
  byId('stop').disabled = !running || sampler;
  if (!state) return say(sampler ? 'Waiting for the stream.' : 'Choose a virtual machine and press Start. For a machine of LinuxCNC start the program with --live.');
  const problems = [];
  if (state.lost > 0) problems.push(`${state.lost} samples are missing in the stream`);
  if (state.overruns > 0) problems.push(`${state.overruns} overruns of the sampler`);
  if (state.refused > 0) problems.push(`${state.refused} lines were left out (last: ${state.last_refused})`);
  if (state.slipped_s > 1) problems.push(`this computer is too slow: ${shown(state.slipped_s)} s behind the clock`);
  if (missed > 0) problems.push(`this page was too slow for ${shown(missed * layout.bin_ms / 1e3)} s of the picture; a recording has them`);
  fail(problems.length > 0 ? problems.join('; ') + '.' : '');
  say((state.ended ? `Ended: ${state.why}. ` : paused !== null ? 'Paused; the stream goes on. ' : state.rows === 0 ? 'Waiting for rows. ' : 'Running: ') + layout.source + (state.recording ? '. Recording.' : '.'));
  byId('record').disabled = state.recording;
  byId('save').disabled = byId('discard').disabled = !state.recording;
  if (state.recording || state.recorded_rows > 0)
    byId('recorded').textContent = `${state.recorded_rows} rows, ${shown(state.recorded_bytes / 1048576, 3)} of at most ${state.most_bytes / 1048576} MB` + (state.recording_stopped ? `; it stopped: ${state.recording_stopped}. Save it.` : '.');
  const drift = state.drift.map((d, i) => [d.axis || String(i + 1), shown(d.level_percent), shown(2 * d.level_deviation_percent, 2), shown(d.viscous_percent), shown(d.trend_percent_per_hour), d.verdict]);
  if (!byId('drift').contains(document.activeElement))
    byId('drift').replaceChildren(...(drift.length === 0 ? [] : [table('Friction as the controller estimates it, against the identified model', [{text: 'axis'}, {text: 'level', unit: '%', number: true},
      {text: '\u00b1 2 deviations', unit: '%', number: true}, {text: 'viscous', unit: '%', number: true}, {text: 'trend', unit: '%/h', number: true}, {text: 'verdict'}], drift)]));
  byId('source').replaceChildren(...[['Source', layout.source], ['Rows', `${state.rows}, one every ${shown(layout.sample_time_ms)} ms`], ['Restarts', String(state.restarts)],
    ...state.out.map((o) => ['Sent by', `${o.where}; ${o.left_out} rows left out`])].flatMap(([k, v]) => [element('dt', {text: k}), element('dd', {text: v})]));
};

// ---- the virtual machine

const optionsOf = (select, entries, wish) => select.replaceChildren(...entries.map(([value, text, disabled]) =>
  element('option', {value, text, disabled, selected: value === wish})));
const drawMotion = () => {
  const motion = machine.motions[byId('motion').value];
  for (const [key, value] of [['size', motion.size_mm], ['speed', motion.speed_mm_per_s]]) {
    byId(key).value = value === null ? '' : Number(value.toPrecision(6));
    byId(key).disabled = !motion.free;
  }
  optionsOf(byId('controller'), motion.controllers.map((c) => [c.choice, `(${c.id}) ${c.label}`]), motion.controllers.find((c) => c.id === 'a')?.choice);
};
const drawMachine = async () => {
  try {
    machine = await get('/api/machine?id=' + encodeURIComponent(byId('machine').value));
  } catch (e) {
    return fail(e.message);
  }
  const names = {circle: 'Circle', eight: 'Eight', trifolium: 'Trifolium', own: 'Circle through all axes', experiment: 'As in the thesis'};
  optionsOf(byId('motion'), Object.keys(machine.motions).map((m) => [m, names[m] || m]), machine.motion);
  drawMotion();
};
const action = (what, body = {}) => async (event) => {
  event?.preventDefault();
  try {
    return await post('/api/live/' + what, body);
  } catch (e) {
    fail(e.message);
    return null;
  }
};

byId('controls').addEventListener('submit', async (event) => {
  event.preventDefault();
  if (asking) return;
  const r = {machine: byId('machine').value, motion: byId('motion').value, controller: byId('controller').value, client,
    friction: Number(byId('friction').value), times: Number(byId('times').value)};
  for (const [key, unit] of [['size', 'mm'], ['speed', 'mm/s']]) if (byId(key).value !== '' && !byId(key).disabled) r[key] = byId(key).value + ' ' + unit;
  asking = byId('start').disabled = true;
  say('Starting \u2026 The machine is identified the first time, which takes seconds.');
  if (!(await action('start', r)())) drawState();
  asking = byId('start').disabled = false;
});
byId('stop').addEventListener('click', action('stop'));
byId('record').addEventListener('click', async () => {
  byId('saved').replaceChildren();
  if (await action('record')()) say('Recording.');
});
byId('discard').addEventListener('click', action('discard'));
byId('save').addEventListener('click', async () => {
  const saved = await action('save')();
  if (!saved) return;
  byId('saved').replaceChildren(`Saved ${saved.rows} rows as ${saved.file}. `, element('button', {type: 'button', text: 'Identify it', onclick: async () => {
    const log = await action('identify')();
    if (log) location.href = `/identify?log=${encodeURIComponent(log.id)}&name=${encodeURIComponent(log.name)}`;
  }}));
});
byId('pause').addEventListener('click', () => {
  paused = paused === null ? now() : null;
  byId('pause').setAttribute('aria-pressed', String(paused !== null));
  byId('pause').textContent = paused === null ? 'Pause' : 'Go on';
  if (paused === null) drawGlitches();
  if (state) drawState();
});
byId('machine').addEventListener('change', drawMachine);
byId('motion').addEventListener('change', drawMotion);

try {
  sampler = (await get('/api/live')).sampler;
  byId('virtual').hidden = sampler;
  if (!sampler) {
    const machines = await get('/api/machines');
    const own = machines.filter((m) => m.id.startsWith('folder/') && !m.refused);
    optionsOf(byId('machine'), machines.map((m) => [m.id, m.name + (m.refused ? ': ' + m.refused : ''), Boolean(m.refused)]),
        (own[0] || machines.find((m) => m.id === 'built-in/biaxial-table'))?.id);
    await drawMachine();
  }
} catch (e) {
  fail(e.message);
}
const events = new EventSource('/api/live/events');
events.onmessage = (e) => take(JSON.parse(e.data));
events.onerror = () => say('stribeck serve does not answer (has it ended?). Trying again.');
draw();
