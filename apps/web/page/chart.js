// Line charts as SVG, with the look of the reports: axes, grid, names, and values under the pointer or by arrow keys.
import {element, shown} from './common.js';

const SVG = 'http://www.w3.org/2000/svg';
const make = (tag, attributes, parent, text) => {
  const e = document.createElementNS(SVG, tag);
  for (const key in attributes) e.setAttribute(key, attributes[key]);
  if (text !== undefined) e.textContent = text;
  if (parent) parent.append(e);
  return e;
};

const niceStep = (range, count) => {
  const raw = range / count;
  const ten = Math.pow(10, Math.floor(Math.log10(raw)));
  return [1, 2, 5, 10].map((d) => d * ten).find((d) => d >= raw * 0.999);
};
const tics = ([low, high], count) => {
  let step = niceStep(high - low, count), all = [];
  const fill = () => {
    all = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) all.push(k * step);
  };
  fill();
  // One number tells no scale.
  for (let finer = 0; all.length < 2 && finer < 3; ++finer) {
    step = niceStep(step * 0.4, 1);
    fill();
  }
  const digits = Math.max(0, Math.min(9, Math.ceil(-Math.log10(step) + 0.01)));
  return all.map((v) => [v, (Math.abs(v) < step / 2 ? 0 : v).toFixed(digits).replace('-', '\u2212')]);
};

const extent = (series, key) => {
  let low = Infinity, high = -Infinity;
  for (const s of series) for (const v of s[key]) if (v !== null) { if (v < low) low = v; if (v > high) high = v; }
  return low <= high ? [low, high] : [0, 1];
};
const padded = ([low, high], share) => {
  const room = (high - low || Math.abs(high) || 1) * share;
  return [low - room, high + room];
};

const LEFT = 58, RIGHT = 12, TOP = 12, BOTTOM = 44;

export class Chart {
  // options: title (for readers of the screen), x, y (labels with units), equal (same scale on both axes), height
  constructor(parent, options) {
    this.options = options;
    this.series = [];
    this.box = element('div', {class: 'chart', tabindex: 0, role: 'img'});
    this.names = element('div', {class: 'names'});
    this.tip = element('div', {class: 'tip', hidden: true});
    parent.append(this.box, this.names);
    this.box.addEventListener('pointermove', (e) => this.point(e));
    this.box.addEventListener('pointerleave', () => this.unpoint());
    this.box.addEventListener('blur', () => this.unpoint());
    this.box.addEventListener('keydown', (e) => this.key(e));
    new ResizeObserver(() => {
      if (Math.abs(this.box.clientWidth - this.width) > 1) this.draw();
    }).observe(this.box);
  }

  // series: {label, look (number of a colour and dash, or 'soft'), x, y, inNames}; marks: extra things to draw with the two scales
  set(series, words, marks = null) {
    this.series = series;
    this.words = words;
    this.marks = marks;
    this.draw();
  }

  draw() {
    const equal = this.options.equal;
    this.width = this.box.clientWidth || 600;
    const height = equal ? Math.min(this.width, 560) : this.options.height || 250;
    let x = equal ? padded(extent(this.series, 'x'), 0.06) : extent(this.series, 'x');
    let y = padded(extent(this.series, 'y'), 0.06);
    const w = this.width - LEFT - RIGHT, h = height - TOP - BOTTOM;
    if (equal) {
      const scale = Math.max((x[1] - x[0]) / w, (y[1] - y[0]) / h);
      const grow = ([a, b], n) => [(a + b) / 2 - scale * n / 2, (a + b) / 2 + scale * n / 2];
      x = grow(x, w);
      y = grow(y, h);
    }
    if (x[1] === x[0]) x = padded(x, 0.5);
    this.px = (v) => LEFT + (v - x[0]) / (x[1] - x[0]) * w;
    this.py = (v) => TOP + h - (v - y[0]) / (y[1] - y[0]) * h;
    const svg = make('svg', {viewBox: `0 0 ${this.width} ${height}`, width: this.width, height, class: 'drawn', 'aria-hidden': 'true'});
    for (const [v, text] of tics(x, Math.max(2, w / 90))) {
      make('line', {x1: this.px(v), x2: this.px(v), y1: TOP, y2: TOP + h, class: 'grid'}, svg);
      make('text', {x: this.px(v), y: TOP + h + 16, 'text-anchor': 'middle'}, svg, text);
    }
    for (const [v, text] of tics(y, Math.max(2, h / 45))) {
      make('line', {x1: LEFT, x2: LEFT + w, y1: this.py(v), y2: this.py(v), class: 'grid'}, svg);
      make('text', {x: LEFT - 6, y: this.py(v) + 4, 'text-anchor': 'end'}, svg, text);
    }
    make('rect', {x: LEFT, y: TOP, width: w, height: h, class: 'axes', fill: 'none'}, svg);
    make('text', {x: LEFT + w / 2, y: height - 8, 'text-anchor': 'middle'}, svg, this.options.x);
    make('text', {transform: `translate(14 ${TOP + h / 2}) rotate(-90)`, 'text-anchor': 'middle'}, svg, this.options.y);
    for (const s of this.series) make('path', {d: this.path(s), class: 'line look-' + s.look}, svg);
    if (this.marks) this.marks(svg, this.px, this.py, make, [LEFT, TOP, w, h]);
    this.cursor = make('g', {class: 'cursor'}, svg);
    this.area = {top: TOP, bottom: TOP + h};
    this.box.replaceChildren(svg, this.tip);
    this.box.setAttribute('aria-label', this.options.title + (this.words ? ': ' + this.words : ''));
    this.names.replaceChildren(...this.series.filter((s) => s.inNames !== false).map((s) => element('span', {class: 'name'},
        this.sample(s.look), s.label)));
  }

  sample(look) {
    const svg = make('svg', {viewBox: '0 0 28 8', width: 28, height: 8, 'aria-hidden': 'true'});
    make('line', {x1: 1, x2: 27, y1: 4, y2: 4, class: 'line look-' + look}, svg);
    return svg;
  }

  path(s) {
    let d = '', pen = false;
    for (let i = 0; i < s.x.length; ++i) {
      if (s.x[i] === null || s.y[i] === null) { pen = false; continue; }
      d += (pen ? 'L' : 'M') + this.px(s.x[i]).toFixed(1) + ' ' + this.py(s.y[i]).toFixed(1);
      pen = true;
    }
    return d;
  }

  // The point of the first series that is nearest in x, or in both directions where x goes to and fro.
  nearest(px, py) {
    const s = this.series.find((one) => one.inNames !== false && one.x.length > 0);
    if (!s) return -1;
    let best = -1, least = Infinity;
    for (let i = 0; i < s.x.length; ++i) {
      if (s.x[i] === null || s.y[i] === null) continue;
      const dx = this.px(s.x[i]) - px, dy = this.options.twoWay ? this.py(s.y[i]) - py : 0;
      if (dx * dx + dy * dy < least) { least = dx * dx + dy * dy; best = i; }
    }
    return best;
  }
  point(e) {
    const box = this.box.getBoundingClientRect();
    this.show(this.nearest(e.clientX - box.left, e.clientY - box.top));
  }
  key(e) {
    const step = {ArrowRight: 1, ArrowLeft: -1, PageUp: 25, PageDown: -25}[e.key];
    if (!step) return;
    e.preventDefault();
    const s = this.series.find((one) => one.inNames !== false);
    if (s) this.show(Math.max(0, Math.min(s.x.length - 1, (this.at || 0) + step)));
  }
  show(i) {
    const s = this.series.find((one) => one.inNames !== false && one.x.length > 0);
    if (i < 0 || !s || s.x[i] === null) return;
    this.at = i;
    const x = s.x[i];
    this.cursor.replaceChildren();
    if (!this.options.twoWay) {
      make('line', {x1: this.px(x), x2: this.px(x), y1: this.area.top, y2: this.area.bottom}, this.cursor);
    }
    const lines = [this.options.x.replace(/ \[.*/, '') + ' ' + shown(x, 4)];
    for (const one of this.options.twoWay ? [s] : this.series) {
      if (one.inNames === false) continue;
      let near = -1, least = Infinity;
      if (one === s) near = i;
      else one.x.forEach((v, k) => { if (v !== null && Math.abs(v - x) < least) { least = Math.abs(v - x); near = k; } });
      if (near < 0 || one.y[near] === null) continue;
      make('circle', {cx: this.px(one.x[near]), cy: this.py(one.y[near]), r: 3.5, class: 'dot look-' + one.look}, this.cursor);
      lines.push(one.label + ' ' + shown(one.y[near], 4));
    }
    this.tip.replaceChildren(...lines.map((text) => element('div', {text})));
    this.tip.hidden = false;
    const left = this.px(x) > this.width / 2;
    this.tip.style.left = left ? 'auto' : this.px(x) + 12 + 'px';
    this.tip.style.right = left ? this.width - this.px(x) + 12 + 'px' : 'auto';
  }
  unpoint() {
    this.tip.hidden = true;
    this.cursor?.replaceChildren();
  }
}
