// What if: settings to a request, its answer to figures. The newest settings are always on their way; the server drops older ones.
import {byId, client, download, element, get, post, shown, table, unitText} from './common.js';
import {Chart} from './chart.js';

const form = {machine: null, changes: new Map(), control: new Map()};
let machine = null;   // what the server says of the chosen machine
let answer = null;    // the last result
let asFile = null;    // the last result without changes
let shownKey = '';
let flying = 0;
let waiting = false;

const contour = new Chart(byId('contour'), {title: 'Contour with magnified error', x: '', y: '', equal: true, twoWay: true});
const errors = new Chart(byId('error'), {title: 'Error over time', x: 'time [s]', y: ''});
const forces = new Chart(byId('force'), {title: 'Force over time', x: 'time [s]', y: ''});
const friction = new Chart(byId('friction'), {title: 'Friction over velocity', x: '', y: '', twoWay: true});

const looks = new Map();  // a controller keeps its colour while others come and go
const lookOf = (id) => {
  const ids = Object.keys(machine.motions).flatMap((m) => machine.motions[m].controllers.map((c) => c.id));
  if (!looks.has(id)) looks.set(id, [...new Set(ids)].indexOf(id) % 8);
  return looks.get(id);
};

// ---- settings

const optionsOf = (select, entries, chosen) => {
  select.replaceChildren(...entries.map(([value, text, disabled]) =>
    element('option', {value, text, disabled, selected: value === chosen})));
};

// `value`: as in the file; `now`: where it stands.
const slider = (id, label, help, {min, max, step, value, now = value, words, input}) => {
  const output = element('output', {for: id});
  const range = element('input', {id, type: 'range', min, max, step, value: now, title: help});
  const undo = element('button', {type: 'button', class: 'undo', 'aria-label': label + ': as in the file', text: 'undo', hidden: true});
  const say = () => {
    output.textContent = words(Number(range.value));
    range.setAttribute('aria-valuetext', output.textContent);
    undo.hidden = Math.abs(Number(range.value) - Number(value)) < 1e-9;
  };
  range.addEventListener('input', () => { say(); input(Number(range.value)); });
  undo.addEventListener('click', () => { range.value = value; say(); input(Number(value)); range.focus(); });
  say();
  return element('div', {class: 'slider'}, element('label', {for: id, text: label}), undo, output, range);
};

const valuesOf = (p) => {
  const which = byId('which').value;
  return Object.entries(p.values).filter(([axis]) => which === '*' || axis === which);
};
const keyOf = (p) => byId('which').value + '.' + p.key;

// One value of the machine: a factor of it, a whole number, or where it is 0 the value itself.
const valueControl = (p, n) => {
  const values = valuesOf(p);
  if (values.length === 0 || (byId('which').value === '*' && values.length < machine.axes.length)) return null;
  const unit = unitText(p.unit);
  const key = keyOf(p);
  const label = p.label || p.key.replace(/\./g, ' \u203a ');
  const set = form.changes.get(key);  // before another axis was looked at
  const change = (entry) => {
    if (entry) form.changes.set(key, entry);
    else form.changes.delete(key);
    ask();
  };
  if (p.kind === 'count') {
    return slider('value-' + n, label, p.doc, {min: 0, max: 8, step: 1, value: values[0][1], now: set ? Number(set.value) : values[0][1], words: String,
      input: (v) => change(v === values[0][1] ? null : {key, value: String(v)})});
  }
  if (values.some(([, v]) => v === 0)) {
    const id = 'value-' + n;
    // One number stands for all axes only where they have the same.
    const same = values.every(([, v]) => v === values[0][1]);
    const turning = values.every(([axis]) => p.turning?.[axis]) ? p.turning[values[0][0]] : null;
    const factor = turning ? turning.factor : 1;  // the server knows the unit of the linear axis
    return element('div', {class: 'slider'}, element('label', {for: id, text: `${label} [${turning ? unitText(turning.unit) : unit || '1'}]`}),
        element('input', {id, type: 'number', step: 'any', value: set ? parseFloat(set.value) * factor : same ? values[0][1] * factor : null, title: p.doc,
          placeholder: same ? null : values.map(([axis, v]) => `${axis} ${shown(v)}`).join(', '), oninput: (e) => {
            const v = Number(e.target.value) / factor;
            change(e.target.value === '' || (same && v === values[0][1]) ? null : {key, value: (v + ' ' + p.unit).trim()});
          }}));
  }
  return slider('value-' + n, label, p.doc, {min: -1, max: 1, step: 0.01, value: 0, now: set ? Math.log10(set.scale).toFixed(2) : 0,
    words: (s) => '\u00d7 ' + shown(Math.pow(10, s), 3) +
      (p.kind === 'scale' ? '' : ':' + values.map(([axis, v], i) => {
        // An axis that turns has units of its own.
        const turning = p.turning?.[axis];
        const last = i + 1 === values.length || turning || p.turning?.[values[i + 1][0]];
        return ` ${values.length > 1 ? axis + ' ' : ''}${shown(v * Math.pow(10, s) * (turning ? turning.factor : 1), 3)}` +
          (last ? ' ' + (turning ? unitText(turning.unit) : unit) : '');
      }).join(',')),
    input: (s) => change(s === 0 ? null : {key, scale: Number(Math.pow(10, s).toPrecision(6))})});
};

const controlSlider = (key, label, unit, value, min, max) => {
  // Ends on the grid of the steps, so that the value of the file can be set again.
  const at = Number(Math.log10(value).toFixed(2));
  const of = (s) => Math.abs(s - at) < 1e-9 ? value : Number(Math.pow(10, s).toPrecision(3));
  return slider('control-' + key, label, label, {
    min: (Math.floor(100 * Math.log10(min)) / 100).toFixed(2), max: Math.log10(max).toFixed(2), step: 0.01, value: at,
    words: (s) => shown(of(s), 3) + ' ' + unit,
    input: (s) => {
      if (of(s) === value) form.control.delete(key);
      else form.control.set(key, of(s) + ' ' + unit);
      ask();
    }});
};

const drawValues = () => {
  const main = [], more = [];
  machine.parameters.forEach((p, n) => {
    const control = valueControl(p, n);
    if (control) (p.main ? main : more).push(control);
  });
  byId('main-sliders').replaceChildren(...main);
  byId('more-sliders').replaceChildren(...more);
};
const drawSliders = () => {
  form.changes.clear();
  form.control.clear();
  drawValues();
  const t = machine.sample_time_ms;
  const control = [controlSlider('sample_time', 'Control period', 'ms', t, Math.max(0.05, t / 10), Math.min(50, t * 5))];
  if (machine.motions[byId('motion').value].free) {
    const omega = machine.motions[byId('motion').value].omega_rad_per_s || 40;
    control.push(controlSlider('omega_t', 'Pole along the path', 'rad/s', omega, 5, 400),
        controlSlider('omega_n', 'Pole across the path', 'rad/s', omega, 5, 400),
        controlSlider('observer_pole', 'Pole of the observer', '1/s', 20, 2, 200));
  }
  byId('control-sliders').replaceChildren(...control);
};

const drawMotion = () => {
  const motion = machine.motions[byId('motion').value];
  for (const [id, value] of [['size', motion.size_mm], ['speed', motion.speed_mm_per_s]]) {
    // Where every axis turns, a mm is a mrad.
    const unit = machine.rotary.every((r) => r) ? 'mrad' : 'mm';
    document.querySelector(`label[for=${id}]`).textContent = id === 'size' ? `Size (radius) [${unit}]` : `Speed [${unit}/s]`;
    byId(id).value = value === null ? '' : Number(value.toPrecision(6));
    byId(id).placeholder = motion.free ? 'by the machine' : motion.thesis ? 'as in the thesis' : 'of its own';
    byId(id).disabled = !motion.free;
  }
  const before = new Set([...document.querySelectorAll('#controllers input:checked, #more-controllers input:checked')].map((i) => i.value));
  const known = motion.controllers.filter((c) => before.has(c.choice)).map((c) => c.id);
  const chosen = new Set(known.length > 0 ? known :
      motion.controllers.filter((c, i) => i === 0 || c.id === 'h').map((c) => c.id));
  // Those that are built in have a name; those of the experiment a letter.
  for (const [id, further] of [['controllers', false], ['more-controllers', true]]) {
    byId(id).replaceChildren(...motion.controllers.filter((c) => (c.choice.length > 1) === further).map((c) =>
      element('label', {class: 'check'}, element('input', {type: 'checkbox', value: c.choice, checked: chosen.has(c.id), onchange: ask}),
          ` (${c.id}) ${c.label}`)));
  }
};

const drawMachine = async () => {
  try {
    machine = await get('/api/machine?id=' + encodeURIComponent(byId('machine').value));
  } catch (e) {
    return fail(e.message);
  }
  looks.clear();
  const names = {circle: 'Circle', eight: 'Eight', trifolium: 'Trifolium', own: 'Circle through all axes', experiment: 'As in the thesis'};
  if (machine.axes.length === 1) names.own = 'Sine';
  const nameOf = (m) => m === 'experiment' && !machine.motions[m].thesis ? machine.motions[m].label : names[m] || m;
  optionsOf(byId('motion'), Object.keys(machine.motions).map((m) => [m, nameOf(m)]), machine.motion);
  const all = machine.axes.length > 1 ? [['*', 'all axes alike']] : [];
  optionsOf(byId('which'), all.concat(machine.axes.map((a) => [a, 'axis ' + a])), all.length > 0 ? '*' : machine.axes[0]);
  byId('identify-changed').checked = false;
  drawMotion();
  drawSliders();
  ask();
};

// ---- asking

const requestOf = () => {
  const r = {
    machine: byId('machine').value,
    motion: byId('motion').value,
    controllers: [...document.querySelectorAll('#controllers input:checked, #more-controllers input:checked')].map((i) => i.value),
    client,
  };
  for (const [id, unit] of [['size', 'mm'], ['speed', 'mm/s']]) {
    if (byId(id).value !== '' && !byId(id).disabled) r[id] = byId(id).value + ' ' + unit;
  }
  if (form.changes.size > 0) r.changes = [...form.changes.values()];
  for (const [key, value] of form.control) r[key] = value;
  if (byId('identify-changed').checked) r.identify_changed = true;
  return r;
};
const baseOf = (r) => JSON.stringify([r.machine, r.motion, r.size, r.speed]);

// One request at a time, so that the figures keep up with a knob that turns; one that takes long gives way to a newer one.
const PATIENCE = 400;
let slow = null;
let sent = 0;
async function ask() {
  const now = performance.now();
  if (flying > 0 && (flying > 1 || now - sent < PATIENCE)) {
    waiting = true;
    if (flying === 1) setTimeout(() => { if (waiting) ask(); }, PATIENCE);
    return;
  }
  waiting = false;
  const request = requestOf();
  if (request.controllers.length === 0) return fail('Choose a controller.');
  ++flying;
  sent = now;
  clearTimeout(slow);
  slow = setTimeout(() => say('Computing \u2026 A machine is identified the first time, which takes seconds.'), 2 * PATIENCE);
  try {
    const result = await post('/api/what-if', request);
    if (result) take(result, request);
  } catch (e) {
    if (!waiting) fail(e.message);
  }
  if (--flying === 0) clearTimeout(slow);
  if (waiting) ask();
}

const say = (text) => { byId('summary').textContent = text; };
const fail = (text) => {
  byId('problem').textContent = text;
  byId('problem').hidden = false;
  byId('drawings').classList.add('old');
  say('No result for these settings.');
};

// ---- the answer

function take(result, request) {
  answer = result;
  byId('problem').hidden = true;
  byId('drawings').classList.remove('old');
  // By what was asked: the sliders may have moved on.
  const plain = !request.changes && !request.identify_changed &&
      !['sample_time', 'omega_t', 'omega_n', 'observer_pole'].some((key) => key in request);
  if (plain) asFile = {base: baseOf(request), rows: new Map(result.result.rows.map((r) => [r.controller, r]))};
  else if (asFile && asFile.base !== baseOf(request)) asFile = null;
  const axes = result.axes.map((a) => [a, 'axis ' + a]);
  const key = result.axes.join();
  if (key !== shownKey) optionsOf(byId('shown-axis'), axes, result.axes[0]);
  shownKey = key;
  drawLead();
  setMagnification(request);
  drawAll();
}

// An axis that turns is carried at a radius of 1 m: its mm are mrad, its N are N m.
const turns = (i) => answer.rotary[i];
const length = (i) => turns(i) ? 'mrad' : 'mm';
// Of an error of all axes together.
const small = () => answer.rotary.every((r) => r) ? '\u00b5rad' : '\u00b5m';

const word = () => answer.axes.length === 1 ? 'tracking error' : 'contour error';

const drawLead = () => {
  const rows = answer.result.rows.filter((r) => !r.refused);
  if (rows.length === 0) return say('No controller follows the path: ' + answer.result.rows[0].refused);
  const best = rows.reduce((a, b) => b.max_contour_error_um < a.max_contour_error_um ? b : a);
  let text = `On ${answer.motion}: (${best.controller}) ${best.label} leaves a ${word()} of at most ${shown(best.max_contour_error_um)} ${small()}`;
  const before = asFile && asFile.rows.get(best.controller);
  if (before && form.changes.size + form.control.size > 0)
    text += `, ${shown(before.max_contour_error_um)} ${small()} with the machine as in the file`;
  else if (rows.length > 1) text += `, ${shown(Math.max(...rows.map((r) => r.max_contour_error_um)))} ${small()} is the largest of the others`;
  say(text + '.');
};

// So that the largest error is a sixth of the size of the path; kept while the user turns it.
let touched = '';
const setMagnification = (request) => {
  const base = baseOf(request) + request.controllers.join();
  if (touched === base) return;
  touched = base;
  const c = answer.curves[0];
  if (!c || answer.axes.length < 2) return;
  const span = Math.max(...[0, 1].map((i) => Math.max(...c.reference_mm[i]) - Math.min(...c.reference_mm[i])));
  // Of what is drawn: the motion before and after it may err more.
  const worst = Math.max(...answer.curves.map((one) => Math.max(...one.error_um.map((e, k) => one.scored[k] ? Math.abs(e) : 0))), 1e-3);
  const wish = Math.log10(span / 6 / (worst * 1e-3));
  byId('magnify').value = Math.min(4, Math.max(0, wish));
};
const magnification = () => Number(Math.pow(10, Number(byId('magnify').value)).toPrecision(2));

const drawContour = () => {
  byId('contour-figure').hidden = answer.axes.length < 2 || answer.curves.length === 0;
  const m = magnification();
  byId('magnified').textContent = '\u00d7 ' + m;
  byId('magnify').setAttribute('aria-valuetext', m + ' times');
  if (byId('contour-figure').hidden) return;
  contour.options.x = `${answer.axes[0]} [${length(0)}]`;
  contour.options.y = `${answer.axes[1]} [${length(1)}]`;
  const first = answer.curves[0];
  const scored = (c, f) => c.scored.map((s, k) => s ? f(k) : null);
  const series = answer.curves.map((c) => ({label: `(${c.controller})`, look: lookOf(c.controller),
    x: scored(c, (k) => c.reference_mm[0][k] + m * 1e-3 * c.across_um[0][k]),
    y: scored(c, (k) => c.reference_mm[1][k] + m * 1e-3 * c.across_um[1][k])}));
  series.push({label: 'path', look: 'soft', x: scored(first, (k) => first.reference_mm[0][k]), y: scored(first, (k) => first.reference_mm[1][k])});
  contour.set(series, `error magnified ${m} times; ` + spoken(), (svg, px, py, make, [left, top, w, h]) => {
    // A bar of a round number of micrometres, about a sixth of the width.
    const perPixel = 1e3 / m / (px(1) - px(0));
    const raw = w / 6 * perPixel;
    const ten = Math.pow(10, Math.floor(Math.log10(raw)));
    const um = [1, 2, 5, 10].map((d) => d * ten).reverse().find((d) => d <= raw) || ten;
    const bar = um / perPixel, x = left + 12, y = top + h - 12;
    make('path', {d: `M${x} ${y - 4}v8M${x} ${y}h${bar}m0 -4v8`, class: 'axes', fill: 'none'}, svg);
    make('text', {x: x + bar + 6, y: y + 4}, svg, `${shown(um)} ${small()}`);
  });
};
const spoken = () => answer.result.rows.map((r) => `(${r.controller}) largest error ` +
  (r.refused ? 'unknown' : shown(r.max_contour_error_um) + (small() === '\u00b5m' ? ' micrometres' : ' microradians'))).join(', ');

const drawAll = () => {
  drawContour();
  byId('error-head').textContent = word().replace(/^./, (c) => c.toUpperCase()) + ' over time';
  errors.options.y = `error [${small()}]`;
  errors.set(answer.curves.map((c) => ({label: `(${c.controller})`, look: lookOf(c.controller), x: c.t_s, y: c.error_um})), spoken());
  drawAxis();
  drawFigures();
  const w = answer.result.warnings;
  byId('warnings').replaceChildren(...(w.length === 0 ? [] : [element('div', {class: 'warnings'}, element('ul', {}, w.map((text) => element('li', {text}))))]));
  byId('made').textContent = `Compensators: ${answer.parameters}. Simulated in ${shown(answer.simulated_in_ms, 2)} ms` +
    (answer.identified_in_ms > 20 ? `, identified in ${shown(answer.identified_in_ms / 1e3, 2)} s.` : '.') +
    (answer.command ? ' The same by the command:' : byId('identify-changed').checked
      ? ' Save the changed machine file to repeat it with the command.'
      : ' These controllers know the machine as its file has it. compare on the saved machine file identifies the changed machine: tick Identify the changed machine to see that here.');
  byId('command').hidden = !answer.command;
  byId('command').textContent = answer.command || '';
};

const drawAxis = () => {
  const i = Math.max(0, answer.axes.indexOf(byId('shown-axis').value));
  forces.options.y = turns(i) ? 'torque [N m]' : 'force [N]';
  friction.options.x = `velocity [${length(i)}/s]`;
  friction.options.y = turns(i) ? 'friction [N m]' : 'friction [N]';
  forces.set(answer.curves.map((c) => ({label: `(${c.controller})`, look: lookOf(c.controller), x: c.t_s, y: c.force_N[i]})), 'axis ' + answer.axes[i]);
  const map = answer.friction[i];
  if (!map) return;
  const v = map.velocity_mm_per_s;
  const kinds = {conventional: 'conventional model', gaussian: 'Gaussian model', eccentric: 'eccentric model', whole: 'whole model'};
  const series = [{label: 'machine', look: 'thick', x: v, y: map.truth_N}];
  map.models.forEach((m, k) => series.push({label: kinds[m.kind], look: [1, 2, 3, 6][k % 4], x: v, y: m.friction_N}));
  if (answer.curves[0]) {
    const c = answer.curves[0];
    series.unshift({label: `during the run of (${c.controller})`, look: 'soft', x: c.velocity_mm_per_s[i], y: c.friction_N[i]});
    series.push(series.shift());
  }
  friction.set(series, 'axis ' + answer.axes[i]);
};

const drawFigures = () => {
  const compared = asFile && form.changes.size + form.control.size > 0;
  const head = [{text: 'controller'}, {text: 'largest', unit: small(), number: true}, {text: 'glitch', unit: small(), number: true},
    {text: 'RMS', unit: small(), number: true}, {text: 'mean', unit: small(), number: true}, {text: 'input', unit: 'mV', number: true}];
  if (compared) head.splice(2, 0, {text: 'as in the file', unit: small(), number: true});
  const rows = answer.result.rows.map((r) => {
    const name = element('span', {}, contour.sample(lookOf(idOf(r))), ` (${r.controller}) ${r.label}`);
    if (r.refused) name.append(element('span', {class: 'note', text: r.refused}));
    const cells = [name, shown(r.max_contour_error_um), shown(r.quadrant_glitch_um), shown(r.rms_um), shown(r.mean_abs_um),
      shown(r.input_variation_V === null ? null : r.input_variation_V * 1e3)];
    if (compared) cells.splice(2, 0, shown(asFile.rows.get(r.controller)?.max_contour_error_um));
    return cells;
  });
  byId('figures').replaceChildren(table(word().replace(/^./, (c) => c.toUpperCase()) + ' of the scored motion', head, rows));
};
const idOf = (row) => row.controller;

// ---- events

byId('machine').addEventListener('change', drawMachine);
byId('motion').addEventListener('change', () => { drawMotion(); drawSliders(); ask(); });
byId('which').addEventListener('change', drawValues);
for (const id of ['size', 'speed', 'identify-changed']) byId(id).addEventListener('input', ask);
byId('magnify').addEventListener('input', () => { if (answer) drawContour(); });
byId('shown-axis').addEventListener('change', () => { if (answer) drawAxis(); });
byId('reset').addEventListener('click', () => { byId('identify-changed').checked = false; drawMotion(); drawSliders(); ask(); });
byId('save').addEventListener('click', async () => {
  try {
    download('changed-machine.toml', await post('/api/machine-file', requestOf()), 'application/toml');
  } catch (e) {
    fail(e.message);
  }
});
byId('controls').addEventListener('submit', (e) => e.preventDefault());

const machines = await get('/api/machines').catch((e) => { fail(e.message); return []; });
const own = machines.filter((m) => m.id.startsWith('folder/') && !m.refused);
optionsOf(byId('machine'), machines.map((m) => [m.id, `${m.name}${m.id.startsWith('folder/') ? ` (${m.file})` : ''}${m.refused ? ': ' + m.refused : ''}`, Boolean(m.refused)]),
    (own[0] || machines.find((m) => m.id === 'built-in/biaxial-table') || machines[0])?.id);
if (machines.length > 0) await drawMachine();
