// A page that computes without a server. It unpacks the module that it carries, lets a worker answer what `stribeck serve` would answer,
// and shows one view of the dashboard: #what-if or #identify. Asks no host.
const partOf = (id) => document.getElementById(id).textContent;
const parts = JSON.parse(partOf('parts'));  // {scripts, views, worker}
const machines = JSON.parse(partOf('machines'));  // text of each file

const unpacked = async (text) => {
  const bytes = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
  if (typeof DecompressionStream === 'undefined') throw new Error('this browser is too old to unpack the page (one of 2023 or later can)');
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer());
};
const linkTo = (text, type) => URL.createObjectURL(new Blob([text], {type}));

// ---- the module

let worker = null;
let next = 1;
const open = new Map();  // id -> {done, client}
const outdated = {status: 200, type: 'application/json', body: new TextEncoder().encode('{"outdated":true}')};
const stopped = (why) => ({status: 422, type: 'application/json',
  body: new TextEncoder().encode(JSON.stringify({error: 'the computing part of this page stopped: ' + why + ' (it has been started again; drop the logs again)'}))});

const module = unpacked(partOf('engine'));
const start = async () => {
  const one = new Worker(linkTo(parts.worker, 'text/javascript'));
  one.onmessage = ({data}) => {
    const asked = open.get(data.id);
    if (data.stopped !== undefined) {
      for (const [, other] of open) other.done(stopped(data.stopped));
      open.clear();
      one.terminate();
      worker = start();
      send();
      return;
    }
    open.delete(data.id);
    if (asked) asked.done(data);
    send();
  };
  one.postMessage({module: await module, machines});
  return one;
};
worker = start();

// One request at a time is with the worker; of a client only the newest waits, as in the server.
let busy = false;
const waiting = [];
const send = async () => {
  busy = false;
  const request = waiting.shift();
  if (!request) return;
  busy = true;
  open.set(request.message.id, request);
  (await worker).postMessage(request.message);
};

// As fetch(), answered here.
globalThis.stribeckFetch = async (target, options = {}) => {
  const text = typeof options.body === 'string';
  const body = options.body === undefined ? new Uint8Array() : text ? new TextEncoder().encode(options.body) :
    new Uint8Array(await options.body.arrayBuffer());
  const client = text ? target + (JSON.parse(options.body).client || Math.random()) : String(Math.random());
  const {status, type, body: answer} = await new Promise((done) => {
    for (let i = waiting.length; i-- > 0;) if (waiting[i].client === client) waiting.splice(i, 1)[0].done(outdated);
    waiting.push({client, done, message: {id: next++, method: options.method || 'GET', target, body}});
    if (!busy) send();
  });
  return new Response(answer, {status, headers: {'Content-Type': type}});
};

// ---- the view

const VIEWS = {'#what-if': 'what-if', '#identify': 'identify'};
const view = VIEWS[location.hash] || 'what-if';
document.getElementById('view').innerHTML = parts.views[view];
document.title = {'what-if': 'What if', identify: 'Identify'}[view] + ' - Stribeck';
document.body.className = 'dashboard';
window.addEventListener('hashchange', () => { if (VIEWS[location.hash] && VIEWS[location.hash] !== view) location.reload(); });

const script = (name, imports) => {
  let text = parts.scripts[name];
  for (const [file, link] of Object.entries(imports)) text = text.replaceAll(`'./${file}.js'`, `'${link}'`);
  return linkTo(text, 'text/javascript');
};
const common = script('common', {});
const chart = script('chart', {common});
module.catch((e) => { document.getElementById('summary').textContent = e.message; });
await import(script(view, {common, chart}));
