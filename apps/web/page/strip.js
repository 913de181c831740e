// Scrolling traces on a canvas: time to the left, of every channel the range between its extremes, so that no peak is lost.
import {element, shown} from './common.js';

const LEFT = 58, RIGHT = 10, TOP = 8, BOTTOM = 36;
const DASHES = [[], [7, 3], [2, 2], [9, 3, 2, 3], [12, 3], [4, 2], [6, 2, 2, 2, 2, 2], []];

// A colour of the style sheet, as the reader's light or dark setting has it.
const colour = (probe, look) => {
  probe.setAttribute('class', 'line look-' + look);
  return getComputedStyle(probe).stroke;
};

const niceStep = (range, count) => {
  const raw = range / count;
  const ten = Math.pow(10, Math.floor(Math.log10(raw)));
  return [1, 2, 5, 10].map((d) => d * ten).find((d) => d >= raw * 0.999);
};
const label = (v, step) => {
  const digits = Math.max(0, Math.min(9, Math.ceil(-Math.log10(step) + 0.01)));
  return (Math.abs(v) < step / 2 ? 0 : v).toFixed(digits).replace('-', '\u2212');
};

export class Strip {
  constructor(parent, title, unit, height = 170) {
    this.title = title;
    this.unit = unit;
    this.height = height;
    this.canvas = element('canvas', {role: 'img', class: 'strip'});
    this.names = element('div', {class: 'names'});
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    this.probe = document.createElementNS('http://www.w3.org/2000/svg', 'line');
    svg.setAttribute('class', 'probe');
    svg.setAttribute('aria-hidden', 'true');
    svg.append(this.probe);
    this.figure = element('figure', {}, element('h2', {text: title + (unit ? ` [${unit}]` : '')}), this.canvas, this.names, svg);
    parent.append(this.figure);
  }

  // traces: [{label, look, channel}]
  set(traces) {
    this.traces = traces;
    const sample = (look) => {
      const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
      svg.setAttribute('viewBox', '0 0 28 8');
      svg.setAttribute('aria-hidden', 'true');
      const line = document.createElementNS('http://www.w3.org/2000/svg', 'line');
      for (const [k, v] of Object.entries({x1: 1, x2: 27, y1: 4, y2: 4, class: 'line look-' + look})) line.setAttribute(k, v);
      svg.append(line);
      return svg;
    };
    this.names.replaceChildren(...(traces.length < 2 ? [] : traces.map((t) => element('span', {class: 'name'}, sample(t.look), t.label))));
  }

  // data: {t, low, high}: lists by channel; shown are the last `window` seconds before `end`; marks: [{t, text}]
  draw(data, end, window, gap, marks) {
    const width = this.canvas.clientWidth || 600;
    const scale = devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * scale)) {
      this.canvas.width = Math.round(width * scale);
      this.canvas.height = Math.round(this.height * scale);
    }
    const c = this.canvas.getContext('2d');
    c.setTransform(scale, 0, 0, scale, 0, 0);
    c.clearRect(0, 0, width, this.height);
    const style = getComputedStyle(this.canvas);
    const w = width - LEFT - RIGHT, h = this.height - TOP - BOTTOM;
    let from = 0;
    while (from < data.t.length && data.t[from] < end - window) ++from;
    let low = Infinity, high = -Infinity;
    for (const trace of this.traces) {
      for (let i = from; i < data.t.length && data.t[i] <= end; ++i) {
        const a = data.low[trace.channel][i], b = data.high[trace.channel][i];
        if (a !== null && a < low) low = a;
        if (b !== null && b > high) high = b;
      }
    }
    this.extent = low <= high ? [low, high] : null;
    if (!(low <= high)) { low = 0; high = 1; }
    const room = (high - low || Math.abs(high) || 1) * 0.08;
    low -= room;
    high += room;
    const px = (t) => LEFT + w * (1 - (end - t) / window);
    const py = (v) => TOP + h * (1 - (v - low) / (high - low));
    const grid = style.getPropertyValue('--line').trim() || '#ccc', ink = style.color;
    c.font = '12px system-ui,sans-serif';
    c.lineWidth = 1;
    c.setLineDash([]);
    c.fillStyle = ink;
    c.textAlign = 'right';
    c.textBaseline = 'middle';
    const step = niceStep(high - low, Math.max(2, h / 36));
    for (let k = Math.ceil(low / step); k * step <= high; ++k) {
      c.strokeStyle = grid;
      c.beginPath();
      c.moveTo(LEFT, py(k * step));
      c.lineTo(LEFT + w, py(k * step));
      c.stroke();
      c.fillText(label(k * step, step), LEFT - 6, py(k * step));
    }
    c.textAlign = 'center';
    c.textBaseline = 'top';
    const every = niceStep(window, Math.max(2, w / 80));
    for (let k = Math.ceil((end - window) / every); k * every <= end; ++k) {
      const x = px(k * every);
      c.strokeStyle = grid;
      c.beginPath();
      c.moveTo(x, TOP);
      c.lineTo(x, TOP + h);
      c.stroke();
      if (x < width - 14) c.fillText(label(k * every, every), x, TOP + h + 4);
    }
    c.fillText('time [s]', LEFT + w / 2, TOP + h + 19);
    c.save();
    c.beginPath();
    c.rect(LEFT, TOP, w, h);
    c.clip();
    for (const mark of marks) {
      if (mark.t < end - window) continue;
      c.strokeStyle = style.getPropertyValue('--soft').trim() || '#777';
      c.setLineDash([3, 3]);
      c.beginPath();
      c.moveTo(px(mark.t), TOP);
      c.lineTo(px(mark.t), TOP + h);
      c.stroke();
      c.fillText(mark.text, px(mark.t) + 8, TOP + 2);
    }
    for (const trace of this.traces) {
      c.strokeStyle = colour(this.probe, trace.look);
      c.setLineDash(DASHES[trace.look % DASHES.length]);
      c.lineWidth = 1.5;
      c.beginPath();
      let before = null;
      for (let i = Math.max(0, from - 1); i < data.t.length && data.t[i] <= end; ++i) {
        const a = data.low[trace.channel][i], b = data.high[trace.channel][i];
        if (a === null || b === null) { before = null; continue; }
        const x = px(data.t[i]);
        // The extremes in the order in which the line is shorter.
        const up = before === null || Math.abs(before.y - a) < Math.abs(before.y - b);
        if (before === null || data.t[i] - before.t > gap) c.moveTo(x, py(up ? a : b));
        else c.lineTo(x, py(up ? a : b));
        c.lineTo(x, py(up ? b : a));
        before = {t: data.t[i], y: up ? b : a};
      }
      c.stroke();
    }
    c.restore();
    c.setLineDash([]);
    c.strokeStyle = ink;
    c.lineWidth = 1;
    c.strokeRect(LEFT, TOP, w, h);
  }

  // For readers of the screen; not at every picture.
  tell() {
    const range = this.extent ? `from ${shown(this.extent[0])} to ${shown(this.extent[1])} ${this.unit}` : 'no values yet';
    this.canvas.setAttribute('aria-label', `${this.title} of the shown time: ${range}`);
  }
}
