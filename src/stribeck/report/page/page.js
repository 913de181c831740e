// Makes the figures of a page answer: zoom, values under the cursor, curves on and off, magnification of errors.
// Needs no network and no library. Without it the same figures stand still.
//
// Every drawing has its frame, ranges, labels and curves in data-plot (plot_facts in frame.cpp). Values are read back from the
// drawn curves, so that nothing is stored twice; they are exact to a tenth of a pixel.
'use strict';
(() => {
const SVG = 'http://www.w3.org/2000/svg';
const make = (name, attributes, parent, text) => {
  const e = document.createElementNS(SVG, name);
  for (const k in attributes) e.setAttribute(k, attributes[k]);
  if (text !== undefined) e.textContent = text;
  if (parent) parent.appendChild(e);
  return e;
};
const button = (name, text, label, parent, click) => {
  const b = document.createElement('button');
  b.type = 'button';
  b.className = name;
  b.textContent = text;
  b.setAttribute('aria-label', label);
  b.addEventListener('click', click);
  parent.appendChild(b);
  return b;
};

// A number with as many digits as a step on the axis makes visible.
const printed = (v, step) => {
  const digits = Math.max(0, Math.min(12, Math.ceil(-Math.log10(step) + 0.01)));
  return (Math.abs(v) < step / 2 ? 0 : v).toFixed(digits).replace('-', '\u2212');
};
const unitOf = (label) => (label.match(/\[(.*)\]$/) || ['', ''])[1];

// One axis: pixels to values and back, also logarithmic.
class Axis {
  constructor(facts, from, to) {
    this.log = facts[2] === 1;
    this.full = [this.inner(facts[0]), this.inner(facts[1])];
    this.now = this.full.slice();
    this.from = from;
    this.to = to;
  }
  inner(v) { return this.log ? Math.log10(v) : v; }
  outer(v) { return this.log ? Math.pow(10, v) : v; }
  pixel(v, range = this.now) {
    return this.from + (v - range[0]) / (range[1] - range[0]) * (this.to - this.from);
  }
  value(px, range = this.now) {
    return range[0] + (px - this.from) / (this.to - this.from) * (range[1] - range[0]);
  }
  zoomed() { return this.now[0] !== this.full[0] || this.now[1] !== this.full[1]; }
  set(low, high) {
    const least = (this.full[1] - this.full[0]) * 1e-3;
    if (high - low < least) return;
    this.now = [Math.max(low, this.full[0]), Math.min(high, this.full[1])];
  }
  step() {
    const raw = (this.now[1] - this.now[0]) / 6;
    const ten = Math.pow(10, Math.floor(Math.log10(raw)));
    return [1, 2, 5, 10].map((d) => d * ten).find((d) => d >= raw) || 10 * ten;
  }
  tics() {
    const step = this.log ? Math.max(this.step(), 1e-3) : this.step();
    const all = [];
    for (let k = Math.ceil(this.now[0] / step); k * step <= this.now[1] + 1e-9 * step; ++k) {
      const v = this.outer(k * step);
      all.push([k * step, this.log ? String(Number(v.toPrecision(3))) : printed(v, step)]);
    }
    return all;
  }
}

// Stretches of [x, y, x, y, …] in pixels, from "M66 273l.8 12.5 .6-6.8z".
const pointsOf = (d) => {
  const all = [];
  let x = 0, y = 0, relative = false, pending = null;
  for (const word of d.match(/[MlLhzZ]|-?\d*\.?\d+(?:e-?\d+)?/g) || []) {
    if (word === 'M' || word === 'L') { relative = false; if (word === 'M') all.push([]); }
    else if (word === 'l') relative = true;
    else if (word === 'h') pending = NaN;
    else if (word === 'z' || word === 'Z') pending = null;
    else if (Number.isNaN(pending)) pending = null;  // the length of a dot
    else if (pending === null) pending = Number(word);
    else {
      x = relative ? x + pending : pending;
      y = relative ? y + Number(word) : Number(word);
      pending = null;
      all[all.length - 1].push(x, y);
    }
  }
  return all;
};

const plots = [];

class Figure {
  constructor(svg) {
    this.svg = svg;
    this.box = svg.parentNode;
    this.facts = JSON.parse(svg.dataset.plot);
    const [left, top, right, bottom] = this.facts.f;
    this.x = new Axis(this.facts.x, left, right);
    this.y = new Axis(this.facts.y, bottom, top);
    this.canvas = svg.querySelector('[id$="gnuplot_canvas"]') || svg;
    this.scale = 1;
    // Drawings on the same axis move together.
    this.key = this.facts.bare || this.facts.named ? null : JSON.stringify([this.facts.xl, this.facts.x]);
    this.curves = this.facts.s.map((s) => ({
      facts: s, shown: true,
      groups: s.g.map((k) => svg.querySelector('[id$="gnuplot_plot_' + k + '"]')).filter(Boolean)
    }));
    this.zoomable = !this.facts.named;
    this.addControls();
  }

  // Everything that needs the curves is prepared when the reader first comes near.
  prepare() {
    if (this.ready) return;
    this.ready = true;
    const [left, top, right, bottom] = this.facts.f;
    const clip = make('clipPath', {id: 'clip-' + plots.indexOf(this)}, this.svg);
    make('rect', {x: left, y: top, width: right - left, height: bottom - top}, clip);
    this.window = make('g', {'clip-path': this.facts.bare ? '' : 'url(#' + clip.id + ')'});
    this.moving = make('g', {}, this.window);
    const first = this.curves.length && this.curves[0].groups[0];
    if (first) first.parentNode.insertBefore(this.window, first);
    for (const c of this.curves) {
      for (const g of c.groups) this.moving.appendChild(g);
      c.paths = c.groups.flatMap((g) => [...g.querySelectorAll('path')]);
      if (!c.facts.fill) c.points = c.paths.flatMap((p) => pointsOf(p.getAttribute('d')));
    }
    this.still = [...this.canvas.children].filter((e) => e !== this.window && e.tagName !== 'rect');
    this.drawn = make('g', {class: 'drawn'}, null);
    if (this.window.parentNode) this.window.parentNode.insertBefore(this.drawn, this.window);
    this.cursor = make('g', {class: 'cursor'}, this.svg);
    this.tip = document.createElement('div');
    this.tip.className = 'tip';
    this.tip.hidden = true;
    this.box.appendChild(this.tip);
  }

  addControls() {
    const svg = this.svg, w = svg.viewBox.baseVal.width, h = svg.viewBox.baseVal.height;
    const place = (e, x, y, width, height) => {
      e.style.left = 100 * x / w + '%';
      e.style.top = 100 * y / h + '%';
      if (width) { e.style.width = 100 * width / w + '%'; e.style.height = 100 * height / h + '%'; }
    };
    this.layer = document.createElement('div');
    this.layer.className = 'layer';
    this.box.appendChild(this.layer);
    this.layer.appendChild(svg);
    for (const c of this.curves) {
      if (!c.facts.b) continue;
      const b = button('key', '', 'curve ' + c.facts.n, this.layer, () => {
        this.prepare();
        c.shown = !c.shown;
        b.setAttribute('aria-pressed', String(c.shown));
        for (const g of c.groups) g.style.display = c.shown ? '' : 'none';
      });
      b.setAttribute('aria-pressed', 'true');
      b.title = 'Show or hide ' + c.facts.n;
      place(b, c.facts.b[0] - 3, c.facts.b[1], c.facts.b[2] + 6, 18);
    }
    if (this.zoomable) {
      this.reset = button('reset', 'whole figure', 'show the whole figure', this.layer, () => this.zoomAll());
      this.reset.hidden = true;
    }
    if (this.facts.ring) this.addMagnifier();
    svg.tabIndex = 0;
    svg.addEventListener('pointerenter', () => this.prepare());
    svg.addEventListener('focus', () => this.prepare());
    svg.addEventListener('pointermove', (e) => this.move(e));
    svg.addEventListener('pointerleave', () => { if (!this.drag) this.leave(); });
    svg.addEventListener('blur', () => this.leave());
    svg.addEventListener('keydown', (e) => this.press(e));
    if (!this.zoomable) return;
    svg.addEventListener('pointerdown', (e) => this.begin(e));
    svg.addEventListener('pointerup', (e) => this.end(e));
    svg.addEventListener('pointercancel', () => this.stop());
    svg.addEventListener('dblclick', () => this.zoomAll());
    svg.addEventListener('wheel', (e) => {
      // The wheel belongs to the page until the reader has chosen this figure.
      if (!e.ctrlKey && document.activeElement !== svg) return;
      e.preventDefault();
      this.prepare();
      const [px, py] = this.place(e);
      this.zoomAt(px, py, e.deltaY > 0 ? 1.25 : 0.8);
    }, {passive: false});
  }

  addMagnifier() {
    const label = document.createElement('label');
    label.className = 'magnify';
    const slider = document.createElement('input');
    const said = document.createElement('output');
    slider.type = 'range';
    slider.min = '-1'; slider.max = '1'; slider.step = '0.05'; slider.value = '0';
    // The drawing tells its own magnification: "error × 300".
    const texts = [...this.svg.querySelectorAll('text')];
    const told = texts.find((t) => /^error × \d+$/.test(t.textContent));
    // Where it does not, the slider tells how much larger than drawn at first.
    const own = told ? Number(told.textContent.slice(8)) : 1;
    const say = () => {
      said.textContent = '×' + Number((own * this.scale).toPrecision(2)) + (told ? '' : ' of the drawing');
      if (told) told.textContent = 'error ' + said.textContent.replace('×', '× ');
    };
    say();
    label.append('error magnified ', slider, said);
    slider.addEventListener('input', () => {
      this.prepare();
      this.scale = Math.pow(5, Number(slider.value));
      say();
      this.magnify();
    });
    this.box.appendChild(label);
  }

  // Errors stand radially on a circle: each point moves along its radius.
  magnify() {
    const [cx, cy, r] = this.facts.ring;
    for (const c of this.curves) {
      if (c.facts.scale === 3) continue;  // an axis or a mark
      for (const p of c.paths) {
        p.original = p.original || pointsOf(p.getAttribute('d'));
        p.setAttribute('d', p.original.map((points) => {
          let d = '';
          for (let i = 0; i < points.length; i += 2) {
            if (c.facts.scale === 2) {  // the bar of the scale grows from its first point on
              const x = p.original[0][0] + (points[i] - p.original[0][0]) * this.scale;
              d += (i ? 'L' : 'M') + x.toFixed(1) + ' ' + points[i + 1];
              continue;
            }
            const dx = points[i] - cx, dy = points[i + 1] - cy, own = Math.hypot(dx, dy) || 1;
            const k = (r + (own - r) * this.scale) / own;
            d += (i ? 'L' : 'M') + (cx + dx * k).toFixed(1) + ' ' + (cy + dy * k).toFixed(1);
          }
          return d;
        }).join(''));
      }
      c.points = c.paths.flatMap((p) => pointsOf(p.getAttribute('d')));
    }
  }

  place(e) {
    const m = this.svg.getScreenCTM().inverse();
    return [m.a * e.clientX + m.e, m.d * e.clientY + m.f];
  }
  inside(px, py) {
    const [left, top, right, bottom] = this.facts.f;
    return px >= left && px <= right && py >= top && py <= bottom;
  }

  move(e) {
    this.prepare();
    const [px, py] = this.place(e);
    if (this.drag) return this.drawFrame(px, py);
    if (!this.inside(px, py)) return this.leave();
    if (this.facts.eq) return this.showNearest(px, py);
    const x = this.x.value(px);
    this.at = x;
    for (const p of this.linked()) p.show(x, p === this);
  }
  linked() {
    if (this.key === null) return [this];
    return plots.filter((p) => {
      if (p === this) return true;
      if (p.key !== this.key) return false;
      const r = p.svg.getBoundingClientRect();
      return r.bottom > 0 && r.top < window.innerHeight && r.width > 0;
    });
  }
  leave() {
    for (const p of plots) p.hide();
  }
  hide() {
    if (!this.ready) return;
    this.cursor.textContent = '';
    this.tip.hidden = true;
  }

  // From pixels of the unzoomed drawing, in which the points are, to present ones.
  now(points, i) {
    return [this.x.pixel(this.x.value(points[i], this.x.full)),
            this.y.pixel(this.y.value(points[i + 1], this.y.full))];
  }

  show(x, own) {
    if (this.facts.named) return;
    this.prepare();
    this.cursor.textContent = '';
    const px = this.x.pixel(x), [left, top, right, bottom] = this.facts.f;
    if (px < left - 0.5 || px > right + 0.5) return this.hide();
    make('line', {x1: px, x2: px, y1: top, y2: bottom}, this.cursor);
    const stepX = this.x.log ? 0 : this.x.step() / 100;
    const rows = [[null, this.facts.xl || 'x',
                   stepX ? printed(x, stepX) : String(Number(this.x.outer(x).toPrecision(4)))]];
    const target = this.x.pixel(x, this.x.full);
    const unit = unitOf(this.facts.yl);
    for (const c of this.curves) {
      if (!c.shown || !c.points) continue;
      let best = null, least = 6 * (this.x.now[1] - this.x.now[0]) / (this.x.full[1] - this.x.full[0]) + 1;
      for (const points of c.points) {
        for (let i = 0; i < points.length; i += 2) {
          const far = Math.abs(points[i] - target);
          if (far < least) { least = far; best = [points, i]; }
        }
      }
      if (!best) continue;
      const [qx, qy] = this.now(best[0], best[1]);
      const y = this.y.value(best[0][best[1] + 1], this.y.full);
      if (this.inside(qx, qy)) make('circle', {cx: qx, cy: qy, r: 3.5, fill: c.facts.c}, this.cursor);
      const value = this.y.log ? String(Number(this.y.outer(y).toPrecision(3))) : printed(y, this.y.step() / 50);
      rows.push([c.facts.c, c.facts.n || this.facts.yl.replace(/ *\[.*\]$/, ''), value + (unit ? ' ' + unit : '')]);
    }
    this.say(rows, px, own);
  }

  // For circles: the point of a curve that is nearest to the pointer.
  showNearest(px, py) {
    this.cursor.textContent = '';
    let best = null, least = 30;
    for (const c of this.curves) {
      if (!c.shown || !c.points || c.facts.scale) continue;
      for (const points of c.points) {
        for (let i = 0; i < points.length; i += 2) {
          const [qx, qy] = this.now(points, i);
          const far = Math.hypot(qx - px, qy - py);
          if (far < least) { least = far; best = [c, points, i, qx, qy]; }
        }
      }
    }
    if (!best) return this.hide();
    const [c, points, i, qx, qy] = best;
    make('circle', {cx: qx, cy: qy, r: 3.5, fill: c.facts.c}, this.cursor);
    const rows = [];
    if (this.facts.ring) {
      const [cx, cy, r, perPixel] = this.facts.ring;
      const dx = points[i] - cx, dy = cy - points[i + 1];
      const angle = (Math.atan2(dy, dx) * 180 / Math.PI + 360) % 360;
      const error = (Math.hypot(dx, dy) - r) / this.scale * perPixel;
      rows.push([null, 'angle', angle.toFixed(1) + '°']);
      rows.push([c.facts.c, (c.facts.n || 'error') + ' outwards', printed(error, perPixel * 0.2) + ' µm']);
    } else {
      rows.push([null, this.facts.xl || 'x', printed(this.x.value(points[i], this.x.full), this.x.step() / 100)]);
      rows.push([c.facts.c, this.facts.yl || c.facts.n || 'y',
                 printed(this.y.value(points[i + 1], this.y.full), this.y.step() / 100)]);
    }
    this.say(rows, qx, true);
  }

  say(rows, px, own) {
    this.tip.textContent = '';
    for (const [color, name, value] of rows) {
      const row = document.createElement('div');
      if (color) {
        const dot = document.createElement('i');
        dot.className = 'swatch';
        dot.style.background = color;
        row.appendChild(dot);
      }
      row.append(name + ': ');
      const b = document.createElement('b');
      b.textContent = value;
      row.appendChild(b);
      this.tip.appendChild(row);
    }
    this.tip.hidden = false;
    this.tip.setAttribute('role', own ? 'status' : 'none');
    const w = this.svg.viewBox.baseVal.width, right = px > w / 2;
    this.tip.style.left = right ? '' : 'calc(' + 100 * px / w + '% + 12px)';
    this.tip.style.right = right ? 'calc(' + 100 * (1 - px / w) + '% + 12px)' : '';
  }

  begin(e) {
    const [px, py] = this.place(e);
    if (e.pointerType !== 'mouse' || e.button !== 0 || !this.inside(px, py)) return;
    this.prepare();
    this.drag = [px, py];
    this.svg.setPointerCapture(e.pointerId);
  }
  frame(px, py) {
    const [left, top, right, bottom] = this.facts.f;
    const clampX = (v) => Math.min(Math.max(v, left), right), clampY = (v) => Math.min(Math.max(v, top), bottom);
    let x1 = clampX(Math.min(px, this.drag[0])), x2 = clampX(Math.max(px, this.drag[0]));
    let y1 = clampY(Math.min(py, this.drag[1])), y2 = clampY(Math.max(py, this.drag[1]));
    if (this.facts.eq) {  // keeps circles round
      const k = Math.max((x2 - x1) / (right - left), (y2 - y1) / (bottom - top));
      const mx = (x1 + x2) / 2, my = (y1 + y2) / 2, w = k * (right - left) / 2, h = k * (bottom - top) / 2;
      [x1, x2, y1, y2] = [mx - w, mx + w, my - h, my + h];
    } else if (y2 - y1 < 12) {
      [y1, y2] = [top, bottom];  // a flat stroke zooms along x alone
    } else if (x2 - x1 < 12) {
      [x1, x2] = [left, right];
    }
    return [x1, x2, y1, y2];
  }
  drawFrame(px, py) {
    const [x1, x2, y1, y2] = this.frame(px, py);
    this.hide();
    make('rect', {x: x1, y: y1, width: x2 - x1, height: y2 - y1}, this.cursor);
  }
  stop() {
    this.drag = null;
    this.leave();
  }
  end(e) {
    if (!this.drag) return;
    const [px, py] = this.place(e);
    const far = Math.hypot(px - this.drag[0], py - this.drag[1]);
    const [x1, x2, y1, y2] = this.frame(px, py);
    this.stop();
    if (far < 8) return;
    this.zoomTo([this.x.value(x1), this.x.value(x2)], [this.y.value(y2), this.y.value(y1)]);
  }
  zoomTo(x, y) {
    this.prepare();
    this.x.set(x[0], x[1]);
    this.y.set(y[0], y[1]);
    this.draw();
    if (this.key === null) return;
    for (const p of plots) {  // the same stretch in every drawing on this axis
      if (p === this || p.key !== this.key || !p.zoomable) continue;
      p.prepare();
      p.x.now = this.x.now.slice();
      p.draw();
    }
  }
  zoomAt(px, py, factor) {
    const part = (axis, at) => [at - (at - axis.now[0]) * factor, at + (axis.now[1] - at) * factor];
    this.zoomTo(part(this.x, this.x.value(px)), this.facts.eq ? part(this.y, this.y.value(py)) : this.y.now);
  }
  zoomAll() {
    this.y.now = this.y.full.slice();
    for (const p of plots) {
      if (p === this || p.key !== this.key || p.key === null || !p.ready) continue;
      p.x.now = p.x.full.slice();
      p.draw();
    }
    this.x.now = this.x.full.slice();
    this.draw();
  }

  draw() {
    if (!this.ready) return;
    const zoomed = this.x.zoomed() || this.y.zoomed();
    this.reset.hidden = !zoomed;
    for (const e of this.still) e.style.display = zoomed ? 'none' : '';
    this.drawn.textContent = '';
    this.svg.classList.toggle('zoomed', zoomed);
    if (!zoomed) return this.moving.removeAttribute('transform');
    const map = (axis) => {
      const a = axis.pixel(axis.full[0]), b = axis.pixel(axis.full[1]);
      const k = (b - a) / (axis.to - axis.from);
      return [k, a - k * axis.from];
    };
    const [kx, dx] = map(this.x), [ky, dy] = map(this.y);
    this.moving.setAttribute('transform', 'matrix(' + [kx, 0, 0, ky, dx, dy].join(' ') + ')');
    this.drawFrameAndTics();
  }
  drawFrameAndTics() {
    const f = this.facts, g = this.drawn, [left, top, right, bottom] = f.f;
    if (!f.bare) {
      for (const [v, text] of this.x.tics()) {
        const x = this.x.pixel(v);
        make('path', {class: 'grid', d: 'M' + x + ' ' + top + 'V' + bottom}, g);
        make('text', {x, y: bottom + 21, 'text-anchor': 'middle'}, g, text);
      }
      for (const [v, text] of this.y.tics()) {
        const y = this.y.pixel(v);
        make('path', {class: 'grid', d: 'M' + left + ' ' + y + 'H' + right}, g);
        make('text', {x: left - 9, y: y + 4, 'text-anchor': 'end'}, g, text);
      }
      make('path', {class: 'axes', d: 'M' + left + ' ' + top + 'V' + bottom + 'H' + right}, g);
      const h = this.svg.viewBox.baseVal.height;
      make('text', {x: (left + right) / 2, y: h - 7, 'text-anchor': 'middle'}, g, f.xl);
      const y = (top + bottom) / 2;
      make('text', {x: 17, y, 'text-anchor': 'middle', transform: 'rotate(-90 17 ' + y + ')'}, g, f.yl);
    }
    make('text', {class: 'title', x: f.bare ? 8 : left, y: f.bare ? 17 : 21}, g, f.t);
    for (const [v, text] of f.m || []) {
      const x = this.x.pixel(this.x.inner(v));
      if (x < left || x > right) continue;
      make('path', {class: 'mark', d: 'M' + x + ' ' + top + 'V' + bottom}, g);
      make('text', {class: 'small', x, y: top - 4, 'text-anchor': 'middle'}, g, text);
    }
    for (const [vx, vy, text, color] of f.n || []) {
      const x = this.x.pixel(this.x.inner(vx)), y = this.y.pixel(this.y.inner(vy));
      if (this.inside(x, y)) make('text', {class: 'small', x, y: y + 4, 'text-anchor': 'middle', fill: color}, g, text);
    }
    for (const c of f.s) {
      if (!c.b) continue;
      const dashes = this.dashes(c);
      make('path', {d: 'M' + c.b[0] + ' ' + (c.b[1] + 9) + 'h24', stroke: c.c, 'stroke-width': 2.5, ...dashes}, g);
      make('text', {x: c.b[0] + 30, y: c.b[1] + 13}, g, c.n);
    }
  }

  dashes(facts) {
    const curve = this.curves.find((c) => c.facts === facts);
    const dashed = curve && curve.paths.find((p) => p.closest('[stroke-dasharray]'));
    return dashed ? {'stroke-dasharray': dashed.closest('[stroke-dasharray]').getAttribute('stroke-dasharray')} : {};
  }

  press(e) {
    const [left, top, right, bottom] = this.facts.f;
    const middle = (this.x.now[0] + this.x.now[1]) / 2;
    const at = this.at === undefined ? middle : Math.min(Math.max(this.at, this.x.now[0]), this.x.now[1]);
    const step = (this.x.now[1] - this.x.now[0]) / (e.shiftKey ? 10 : 100);
    if (e.key === 'ArrowRight' || e.key === 'ArrowLeft') {
      if (this.facts.eq) return;
      this.at = at + (e.key === 'ArrowRight' ? step : -step);
      for (const p of this.linked()) p.show(this.at, p === this);
    } else if (this.zoomable && (e.key === '+' || e.key === '-')) {
      this.zoomAt(this.facts.eq ? (left + right) / 2 : this.x.pixel(at), (top + bottom) / 2, e.key === '+' ? 0.5 : 2);
    } else if (this.zoomable && (e.key === '0' || e.key === 'Escape')) {
      this.zoomAll();
      this.leave();
    } else {
      return;
    }
    e.preventDefault();
  }
}

for (const svg of document.querySelectorAll('svg[data-plot]')) plots.push(new Figure(svg));
for (const hint of document.querySelectorAll('.with-script')) hint.hidden = false;

// A figure that is wider than the screen is marked at the edge beyond which it goes on.
const frames = [...document.querySelectorAll('.plots>div')];
const mark = (d) => d.classList.toggle('cut', d.scrollLeft + d.clientWidth < d.scrollWidth - 1);
for (const d of frames) {
  mark(d);
  d.addEventListener('scroll', () => mark(d));
}
addEventListener('resize', () => frames.forEach(mark));
})();
