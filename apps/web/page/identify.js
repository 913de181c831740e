// Identify: logs that are dropped, how they are read, and what they tell.
import {byId, client, download, element, followed, post, send, shown, table, unitText} from './common.js';
import {Chart} from './chart.js';

const logs = [];        // {id, name, inspected}
let chosen = new Map(); // column -> {quantity, unit}, where the user changed the proposal
let result = null;
let asked = 0;

const curve = new Chart(byId('curve'), {title: 'Friction over velocity', x: 'velocity [mm/s]', y: 'friction [N]', height: 320});

const QUANTITIES = [['', 'not used'], ['t', 'time'], ['x', 'position'], ['r', 'commanded position'], ['v', 'velocity'], ['a', 'acceleration'],
  ['force', 'force'], ['torque', 'torque'], ['current', 'current'], ['voltage', 'voltage'], ['percent', 'percent of the drive']];

const say = (text) => { byId('summary').textContent = text; };
const fail = (text) => {
  byId('problem').textContent = text;
  byId('problem').hidden = false;
};
const clear = () => { byId('problem').hidden = true; };

// ---- logs

const drawLogs = () => {
  byId('logs').replaceChildren(...logs.map((log) => element('li', {}, element('div', {class: 'row'},
      element('span', {}, log.name, log.inspected ? element('small', {text: ` ${log.inspected.format}, ${log.inspected.rows} rows`}) : null),
      element('button', {type: 'button', text: 'Remove', 'aria-label': 'Remove ' + log.name, onclick: () => remove(log)})))));
  byId('reading').hidden = byId('how').hidden = logs.length === 0;
};
const remove = (log) => {
  logs.splice(logs.indexOf(log), 1);
  post('/api/forget?id=' + log.id, {}).catch(() => {});
  chosen.clear();
  drawLogs();
  inspect();
};
const add = async (files) => {
  clear();
  for (const file of files) {
    say(`Receiving ${file.name} \u2026`);
    try {
      logs.push(await send('/api/logs?name=' + encodeURIComponent(file.name), file));
    } catch (e) {
      fail(file.name + ': ' + e.message);
    }
  }
  drawLogs();
  inspect();
};

const requestOf = () => {
  const r = {logs: logs.map((l) => l.id), client};
  for (const key of ['axis', 'gain', 'lead', 'sample_time', 'mass']) if (byId(key).value.trim() !== '') r[key] = byId(key).value.trim();
  const maps = [...chosen].map(([name, c]) => c.quantity === '' ? 'none=' + name : `${c.quantity}=${name} ${c.unit}`.trim());
  if (maps.length > 0) r.maps = maps;
  return r;
};

// ---- what they hold

async function inspect() {
  byId('result').hidden = true;
  ++asked;  // whatever is still on its way is of other logs
  if (logs.length === 0) {
    byId('inspection').replaceChildren();
    return say('Drop the log of an axis: mass, friction and load follow, with 95 % intervals.');
  }
  const number = ++asked;
  say('Looking into the logs \u2026');
  try {
    const request = requestOf();
    delete request.mass;
    const answer = await post('/api/inspect', request);
    if (!answer || number !== asked) return;
    clear();
    for (const one of answer.logs) {
      const log = logs.find((l) => l.id === one.id);
      if (log) log.inspected = one;
    }
  } catch (e) {
    if (number === asked) {
      fail(e.message);
      say('This could not be read.');
    }
    return;
  }
  drawLogs();
  drawColumns();
  drawInspection();
}

// The column that a quantity was taken from: the longest name that its description begins with.
const proposals = (inspected) => {
  const all = new Map();
  for (const [quantity, words] of Object.entries(inspected.axis || {})) {
    let best = null, length = 0;
    for (const c of inspected.columns) {
      for (const name of [c.header, c.name]) if (name && words.startsWith(name) && name.length > length) { best = c; length = name.length; }
    }
    if (best) all.set(best.name, quantity);
  }
  return all;
};

const drawColumns = () => {
  const first = logs[0].inspected;
  if (!first) return;
  const proposed = proposals(first);
  const cells = first.columns.filter((c) => c.min !== undefined).slice(0, 60).flatMap((c, i) => {
    const mine = chosen.get(c.name);
    const quantity = mine ? mine.quantity : proposed.get(c.name) || (c.unit === 's' && i === 0 ? 't' : '');
    const range = c.min === c.max ? `always ${shown(c.min)}` : `${shown(c.min)} to ${shown(c.max)}`;
    const select = element('select', {id: 'column-' + i}, QUANTITIES.map(([value, text]) => element('option', {value, text, selected: value === quantity})));
    const unit = element('input', {id: 'unit-' + i, type: 'text', value: mine ? mine.unit : c.unit, 'aria-label': 'Unit of ' + c.name, placeholder: 'unit', maxlength: 20});
    const change = () => {
      // A quantity has one column.
      for (const [name, other] of chosen) if (select.value !== '' && other.quantity === select.value) chosen.delete(name);
      chosen.set(c.name, {quantity: select.value, unit: unit.value.trim()});
      inspect();
    };
    select.addEventListener('change', change);
    unit.addEventListener('change', change);
    return [element('div', {}, element('label', {for: 'column-' + i, text: `${c.name} (${range})`}), element('div', {class: 'pair'}, select, unit))];
  });
  byId('columns').replaceChildren(element('div', {class: 'columns-of-log'}, cells));
};

const listOf = (heading, items, name) => items.length === 0 ? null :
  element('div', {class: name}, element('p', {text: heading}), element('ul', {}, items.slice(0, 20).map((text) => element('li', {text}))));

const drawInspection = () => {
  const parts = [];
  let usable = true;
  for (const log of logs) {
    const i = log.inspected;
    if (!i) continue;
    usable = usable && i.usable;
    parts.push(element('h2', {class: 'plain', text: log.name}));
    if (i.refused) parts.push(element('p', {class: 'warnings', text: i.refused}));
    if (i.axis) parts.push(element('p', {text: 'Taken as: ' + Object.entries(i.axis).map(([q, c]) => `${q} = ${c}`).join(', ')}));
    parts.push(listOf('It can tell', i.can_tell, 'list'), listOf('It cannot tell', i.cannot_tell, 'list'),
        listOf('Notes', i.notes.concat(i.findings.map((f) => f.text)), 'list'));
  }
  byId('inspection').replaceChildren(...parts.filter((p) => p));
  byId('identify').disabled = !usable;
  say(usable ? 'These logs can be identified. Check what the columns were taken for, then identify.' :
      'Not yet: say what the columns are, or take another log.');
};

// ---- what they tell

byId('controls').addEventListener('submit', async (event) => {
  event.preventDefault();
  if (logs.length === 0) return;
  clear();
  const number = ++asked;
  byId('identify').disabled = true;
  say('Identifying \u2026');
  try {
    const answer = await post('/api/identify', {...requestOf(), method: byId('method').value, model: byId('model').value});
    // Logs or settings may be others by now.
    if (answer && number === asked) {
      result = answer;
      drawResult();
    }
  } catch (e) {
    if (number === asked) {
      byId('result').hidden = true;
      fail(e.message);
      say('These logs do not give an answer.');
    }
  }
  byId('identify').disabled = false;
});

const interval = (ci) => ci && ci[0] !== null ? `${shown(ci[0], 4)} to ${shown(ci[1], 4)}` : '\u2013';

const drawResult = () => {
  // As the page of this result says it: an axis that turns in deg and N m.
  const {force, velocity, per_velocity: perVelocity, parameters, rotary} = result.shown;
  const mass = parameters.find((p) => p.name === 'mass');
  const level = parameters.find((p) => p.name.startsWith('coulomb'));
  const parts = [];
  if (result.mass_kg !== null && result.mass_kg !== undefined && !rotary)
    parts.push(['Mass', shown(result.mass_kg, 4), 'kg', interval(result.mass_ci95_kg)]);
  else if (mass) parts.push([rotary ? 'Inertia' : 'Mass', shown(mass.value, 4), unitText(mass.unit), interval(mass.ci95)]);
  if (level) parts.push([level.name.replace(/_/g, ' ').replace(/^./, (c) => c.toUpperCase()), shown(level.value, 4), unitText(level.unit), interval(level.ci95)]);
  if (result.r_squared !== null && result.r_squared !== undefined) parts.push(['Explained', shown(100 * result.r_squared, 4), '%', '']);
  byId('numbers').replaceChildren(...parts.map(([name, value, unit, ci]) => element('div', {}, element('dt', {text: name}),
      element('dd', {}, value, element('small', {text: ' ' + unit}), ci ? element('small', {text: ` (95 %: ${ci})`}) : null))));
  say(`${result.model} model by ${result.method}, from ${result.rows} rows: ` + (parts.length > 0 ?
    `${parts[0][0].toLowerCase()} ${parts[0][1]} ${parts[0][2]}, 95 % interval ${parts[0][3]}.` : 'done.') +
    (result.warnings.length > 0 ? ` ${result.warnings.length} warning${result.warnings.length > 1 ? 's' : ''} below.` : ''));

  const v = result.curve.map((p) => (p.velocity_mm_per_s ?? p.velocity) * perVelocity);
  const f = result.curve.map((p) => p.friction_N ?? p.friction);
  const ci = result.curve.map((p) => p.ci95_N ?? p.ci95 ?? [null, null]);
  curve.options.x = `velocity [${velocity}]`;
  curve.options.y = `friction [${force}]`;
  // Between the directions friction jumps: no line joins them.
  const turn = v.findIndex((one) => one > 0);
  const broken = (values) => turn > 0 ? [...values.slice(0, turn), null, ...values.slice(turn)] : values;
  const [bv, low, high] = [v, ci.map((c) => c[0]), ci.map((c) => c[1])].map(broken);
  curve.set(v.length === 0 ? [] : [{label: 'identified friction', look: 'thick', x: bv, y: broken(f)},
    {label: '95 % interval', look: 0, x: [...bv, null, ...bv], y: [...high, null, ...low]}],
  'from ' + shown(Math.min(...v)) + ' to ' + shown(Math.max(...v)));

  byId('warnings').replaceChildren(...[listOf('Warnings', result.warnings, 'warnings'), listOf('The logs cannot tell', result.cannot_tell || [], 'list')].filter((p) => p));
  const head = [{text: 'parameter'}, {text: 'value', number: true}, {text: '95 % from', number: true}, {text: 'to', number: true},
    {text: 'unit'}, {text: 'determined'}];
  const row = (p) => [p.name.replace(/_/g, ' '), shown(p.value, 4), shown(p.ci95?.[0], 4), shown(p.ci95?.[1], 4), unitText(p.unit || ''), p.identifiable ? 'yes' : 'no'];
  // Terms of a map mean something together only: the figure shows them.
  const isTerm = (p) => /^(friction_at|gaussian|eta)/.test(p.name);
  byId('parameters').replaceChildren(table('Parameters', head, parameters.filter((p) => !isTerm(p)).map(row)),
      element('details', {}, element('summary', {text: 'Parameters of the friction map'}),
          table('Parameters of the friction map', head, parameters.filter(isTerm).map(row))));
  const rms = Object.keys(result.models[0] || {}).find((k) => k.startsWith('held_out_rms'));
  byId('models').replaceChildren(...(result.models.length === 0 ? [] : [element('details', {}, element('summary', {text: 'Models that were tried'}),
      table('Models that were tried', [{text: 'model'}, {text: 'parameters', number: true},
        {text: 'error on held-out motion', unit: force, number: true}, {text: ''}],
      result.models.map((m) => [m.name, String(m.parameters), shown(m[rms], 4), m.chosen ? 'chosen' : ''])))]));
  byId('text').textContent = result.text;
  byId('command').textContent = result.command;
  byId('page').href = '/results/page?id=' + encodeURIComponent(result.id);
  byId('save').disabled = !result.axis_file;
  byId('save').title = result.axis_file_refused || '';
  if (!result.axis_file) byId('warnings').append(element('p', {class: 'remark', text: 'No axis file: ' + result.axis_file_refused}));
  byId('result').hidden = false;
  curve.draw();
};

// ---- events

byId('save').addEventListener('click', () => download((result.axis || 'axis') + '.toml', result.axis_file, 'application/toml'));
byId('page').addEventListener('click', (e) => followed(e).catch((error) => fail(error.message)));
byId('files').addEventListener('change', (e) => { add([...e.target.files]); e.target.value = ''; });
for (const key of ['axis', 'gain', 'lead', 'sample_time']) byId(key).addEventListener('change', inspect);
const drop = byId('drop');
for (const [name, over] of [['dragenter', true], ['dragover', true], ['dragleave', false], ['drop', false]]) {
  drop.addEventListener(name, (e) => {
    e.preventDefault();
    drop.classList.toggle('over', over);
    if (name === 'drop') add([...e.dataTransfer.files]);
  });
}
// A file that is dropped beside the field must not replace the page.
for (const name of ['dragover', 'drop']) window.addEventListener(name, (e) => e.preventDefault());

// A recording of the view Live comes with the address.
const given = new URLSearchParams(location.search);
if (given.get('log')) {
  logs.push({id: given.get('log'), name: given.get('name') || 'log.csv'});
  drawLogs();
  inspect();
}
