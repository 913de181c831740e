// In a worker, so that the page stays alive while it computes. First message: {module, machines: {name: text}}; then {id, method, target,
// body}, each answered by {id, status, type, body}. `stribeck` is the module that stands above in this file.
let engine = null;

const started = async ({module, machines}) => {
  const made = await stribeck({wasmBinary: module, print: () => {}, printErr: () => {}});
  made.FS.mkdir('/machines');
  for (const [name, text] of Object.entries(machines)) made.FS.writeFile('/machines/' + name, text);
  return made;
};

// A text or bytes in the memory of the module, with the zero that ends a text.
const placed = (m, bytes) => {
  const at = m._malloc(bytes.length + 1);
  if (at === 0) throw new Error('out of memory (take a shorter log)');
  m.HEAPU8.set(bytes, at);
  m.HEAPU8[at + bytes.length] = 0;
  return at;
};

const answerOf = (m, {method, target, body}) => {
  const encoder = new TextEncoder();
  const texts = [encoder.encode(method), encoder.encode(target), body];
  const at = texts.map((t) => placed(m, t));
  const status = m._stribeck_ask(at[0], at[1], at[2], body.length);
  at.forEach((a) => m._free(a));
  const from = m._stribeck_body();
  return {status, type: m.UTF8ToString(m._stribeck_type()), body: m.HEAPU8.slice(from, from + m._stribeck_body_size())};
};

onmessage = async ({data}) => {
  if (data.module) {
    engine = started(data);
    return;
  }
  try {
    const m = await engine;
    postMessage({id: data.id, ...answerOf(m, data)});
  } catch (e) {
    // A module that stopped computes nothing more: the page starts another one.
    postMessage({id: data.id, stopped: String(e && e.message || e)});
  }
};
