// Small helpers of both views. Needs no library and asks no other host.

export const element = (tag, attributes = {}, ...children) => {
  const e = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'text') e.textContent = value;
    else if (key.startsWith('on')) e.addEventListener(key.slice(2), value);
    else if (value === true) e.setAttribute(key, '');
    else if (value !== false && value !== null && value !== undefined) e.setAttribute(key, value);
  }
  for (const child of children.flat()) if (child !== null) e.append(child);
  return e;
};

export const byId = (id) => document.getElementById(id);

// A number with the digits that matter, with a true minus.
export const shown = (x, digits = 3) => {
  if (x === null || x === undefined || !Number.isFinite(x)) return '\u2013';
  const a = Math.abs(x);
  const text = a !== 0 && (a >= 1e6 || a < 1e-3) ? x.toExponential(digits - 1).replace('e+', 'e') :
      String(Number(x.toPrecision(digits)));
  return text.replace('-', '\u2212');
};

// Units as people write them.
export const unitText = (unit) => unit.replace(/^um/, '\u00b5m').replace(/\bum\b/, '\u00b5m')
    .replace(/([a-z])2\b/g, '$1\u00b2').replace(/ /g, '\u00b7');

export class Refused extends Error {}

const answerOf = async (response) => {
  const type = response.headers.get('Content-Type') || '';
  const answer = type.startsWith('application/json') ? await response.json() : await response.text();
  if (!response.ok) throw new Refused(answer.error || 'the server answered ' + response.status);
  if (answer.outdated) return null;
  return answer;
};

// A page without a server answers itself (apps/web/offline/boot.js).
const carried = globalThis.stribeckFetch || ((target, options) => fetch(target, options));
const asked = async (target, options) => {
  let response;
  try {
    response = await carried(target, options);
  } catch {
    throw new Refused('stribeck serve does not answer (has it ended?)');
  }
  return answerOf(response);
};
export const get = (target) => asked(target);
// null: a newer request of this page came first.
export const post = (target, body) => asked(target, {
  method: 'POST',
  headers: {'Content-Type': 'application/json'},
  body: JSON.stringify(body),
});
export const send = (target, bytes) => asked(target, {method: 'POST', body: bytes});

// A link to a page that is made on request: without a server it is made here.
export const followed = async (event) => {
  if (!globalThis.stribeckFetch) return;
  event.preventDefault();
  const text = await get(event.currentTarget.getAttribute('href'));
  window.open(URL.createObjectURL(new Blob([text], {type: 'text/html'})), '_blank', 'noopener');
};

export const download = (name, text, type) => {
  const link = element('a', {href: URL.createObjectURL(new Blob([text], {type})), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

// Of each page only the newest request is computed.
export const client = Array.from(crypto.getRandomValues(new Uint8Array(8)), (b) => b.toString(16)).join('');

export const table = (caption, head, rows) => element('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption},
    element('table', {},
        element('caption', {text: caption}),
        element('thead', {}, element('tr', {}, head.map((h) => element('th', {scope: 'col', class: h.number ? 'n' : null},
            h.text, h.unit ? element('span', {class: 'unit', text: h.unit}) : null)))),
        element('tbody', {}, rows.map((row) => element('tr', {}, row.map((cell, i) =>
            element('td', {class: head[i].number ? 'n' : null}, cell)))))));
