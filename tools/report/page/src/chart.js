// A chart on uPlot: its colours follow the theme, its width the page; it tells values, zooms, and obeys keys.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import {el} from './dom.js';
import {power} from './format.js';
import {color, onTheme} from './theme.js';
import {hideTooltip, showTooltip} from './tooltip.js';

const font = '12px system-ui, sans-serif';
const keysHint = 'Arrow keys move the cursor, plus and minus zoom, 0 shows all.';

function axis({label, log, size, zero}, side) {
  const all = (u, marks) => marks, named = mark => mark === zero ? '0' : power(mark);
  const line = {stroke: () => color('grid'), width: 1, ...(log && {filter: all})};
  return {
    side,
    label,
    font,
    labelFont: font,
    size: size ?? (side === 3 ? 64 : 36),
    labelSize: 20,
    stroke: () => color('ink-2'),
    grid: line,
    ticks: {...line, size: 4},
    ...(log && {splits: (u, i, from, to) => logMarks(from, to, zero), filter: all, values: (u, marks) => marks.map(named)}),
  };
}

// Where a logarithmic axis for values from `least` up shows those that are 0: far enough below to have a line of its own.
export const floorBelow = least => least / 4;

// Round values; the fewer to a decade, the more decades there are. `zero` is the place that stands for 0, if there is one.
function logMarks(from, to, zero) {
  if (zero) return [zero, ...logMarks(2 * zero, to)];
  const [first, last] = [from, to].map(Math.log10), decades = last - first;
  const digits = decades > 2.2 ? [1] : decades > 1.2 ? [1, 2, 5] : [1, 2, 3, 4, 5, 7];
  const marks = [];
  for (let exponent = Math.floor(first); exponent <= last; exponent++) {
    marks.push(...digits.map(digit => Number(`${digit}e${exponent}`)));
  }
  return marks.filter(mark => mark >= from * 0.999 && mark <= to * 1.001);
}

// Bars as wide as their place allows, at least a pixel.
export function bars(u, index, first, last) {
  const path = new Path2D(), [xs, ys] = [u.data[0], u.data[index]];
  const base = u.bbox.top + u.bbox.height;
  const span = u.scales.x.max - u.scales.x.min;
  const gaps = [];
  for (let i = first + 1; i <= last; i++) gaps.push(xs[i] - xs[i - 1]);
  const least = gaps.length ? Math.min(...gaps.slice(0, 5000)) : span;
  const width = Math.max(devicePixelRatio, Math.min(24, 0.8 * u.bbox.width * least / span));
  for (let i = first; i <= last; i++) {
    if (ys[i] === null) continue;
    const x = u.valToPos(xs[i], 'x', true), y = u.valToPos(ys[i], 'y', true);
    path.rect(x - width / 2, y, width, Math.max(0, base - y));
  }
  return {fill: path, stroke: null, clip: null, band: null, gaps: null, flags: 3};
}

export const steps = uPlot.paths.stepped({align: -1});
// A value holds until the next.
export const holds = uPlot.paths.stepped({align: 1});

// [xs, ys, ...] of lists that have xs of their own: [[xs, ys], ...].
export const joined = lists => uPlot.join(lists);

export class Chart {
  // x, y: {label, log, range: [from, to], zero: the place that stands for 0 on a logarithmic axis, if there is one}. data: [xs, ys, ...]. series: [{color, fill, paths, width, points, spanGaps}].
  // labels: [[index, y, text]], those first that are to be seen where there is no room for all.
  // tell(index) gives a tooltip [title, rows]. pick: 'point' takes the nearest point, else the nearest x. onRange: after
  // a zoom. sync: charts of the same name share their cursor.
  constructor({label, height, x, y, series, data, labels, tell, pick, onRange, sync}) {
    this.tell = tell;
    this.labels = labels ?? [];
    this.full = x.range;
    this.yRange = y.range;
    this.floor = y.zero;
    this.byPoint = pick === 'point';
    this.element = el('.chart', {tabindex: '0', role: 'group', 'aria-label': `${label}. ${keysHint}`});
    this.options = {
      height,
      legend: {show: false},
      padding: [10, 14, 0, 0],
      scales: {
        x: {time: false, distr: x.log ? 3 : 1, range: (u, from, to) => this.isWhole(u, from, to) ? this.full : [from, to]},
        y: {distr: y.log ? 3 : 1, range: () => this.yRange},
      },
      axes: [axis(x, 2), axis(y, 3)],
      series: [{}, ...series.map(s => ({
        stroke: s.color && (() => color(s.color)),
        fill: s.fill && (() => color(s.fill)),
        width: s.width ?? 1.5,
        spanGaps: s.spanGaps,
        paths: s.paths,
        points: {show: false, ...s.points},
      }))],
      cursor: {
        y: this.byPoint,
        points: {show: !this.byPoint, size: 7},
        drag: {x: true, y: false, dist: 6},
        sync: sync ? {key: sync, setSeries: false} : undefined,
      },
      hooks: {
        drawAxes: [u => this.drawFloor(u)],
        draw: [u => this.drawLabels(u)],
        setCursor: [u => this.pointAt(u)],
        setScale: [(u, key) => key === 'x' && onRange && onRange(u.scales.x.min, u.scales.x.max)],
      },
    };
    this.data = data;
    this.element.addEventListener('keydown', event => this.press(event));
    this.element.addEventListener('mouseleave', hideTooltip);
    this.element.addEventListener('blur', hideTooltip);
    onTheme(() => this.plot?.redraw(false));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  // uPlot asks with the ends of the data where all is to be seen.
  isWhole({data: [xs]}, from, to) { return !xs.length || from === xs[0] && to === xs[xs.length - 1]; }

  resize() {
    const width = this.element.clientWidth;
    if (width === 0) return;
    if (!this.plot) {
      this.plot = new uPlot({...this.options, width}, this.data, this.element);
    } else if (width !== this.plot.width) {
      this.plot.setSize({width, height: this.options.height});
    }
  }

  // The line on which values of 0 lie.
  drawFloor({ctx, bbox, valToPos}) {
    if (!this.floor) return;
    const y = Math.round(valToPos(this.floor, 'y', true));
    ctx.save();
    [ctx.strokeStyle, ctx.lineWidth] = [color('ink-2'), devicePixelRatio];
    ctx.setLineDash([5, 4].map(length => length * devicePixelRatio));
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    ctx.restore();
  }

  // Beside their points, where they cover neither points nor each other.
  drawLabels(u) {
    const {ctx, bbox} = u, dpr = devicePixelRatio, half = 7 * dpr, gap = 10 * dpr;
    const at = this.labels.map(([i, y]) => [u.valToPos(u.data[0][i], 'x', true), u.valToPos(y, 'y', true)]);
    const taken = at.map(([x, y]) => [x - 5 * dpr, y - 5 * dpr, x + 5 * dpr, y + 5 * dpr]);
    if (this.floor) taken.push([bbox.left, u.valToPos(this.floor, 'y', true), Infinity, Infinity]);
    const isFree = ([left, top, right, bottom]) =>
        left >= bbox.left && right <= bbox.left + bbox.width && top >= bbox.top && bottom <= bbox.top + bbox.height &&
        taken.every(([l, t, r, b]) => right < l || left > r || bottom < t || top > b);
    ctx.save();
    ctx.font = `${12 * dpr}px system-ui, sans-serif`;
    [ctx.fillStyle, ctx.strokeStyle, ctx.lineWidth] = [color('ink-2'), color('paper'), 4 * dpr];
    [ctx.textAlign, ctx.textBaseline] = ['left', 'middle'];
    for (const [k, [, , text]] of this.labels.entries()) {
      const [x, y] = at[k], {width} = ctx.measureText(text);
      const boxes = [[x + gap, y], [x - gap - width, y], [x - width / 2, y - 2 * half], [x - width / 2, y + 2 * half]]
                        .map(([left, middle]) => [left, middle - half, left + width, middle + half]);
      const box = boxes.find(isFree);
      if (!box) continue;
      taken.push(box);
      ctx.strokeText(text, box[0], box[1] + half);
      ctx.fillText(text, box[0], box[1] + half);
    }
    ctx.restore();
  }

  // Other values at the same xs, on a scale of their own.
  update(data, yRange) {
    [this.data, this.yRange] = [data, yRange];
    const x = this.plot?.scales.x;
    const isWhole = !x || x.min === this.full[0] && x.max === this.full[1];
    this.plot?.setData(data, isWhole);
    if (!isWhole) this.setHeight(yRange);
  }

  show(from, to) {
    const now = this.plot?.scales.x;
    if (now && (now.min !== from || now.max !== to)) this.plot.setScale('x', {min: from, max: to});
  }

  showAll() { this.show(...this.full); }

  setHeight(range) {
    this.yRange = range;
    this.plot?.setScale('y', {min: range[0], max: range[1]});
  }

  isActive() { return this.element.matches(':hover') || document.activeElement === this.element; }

  nearestPoint(u) {
    let best = null, least = 24 ** 2;
    for (let i = 0; i < u.data[0].length; i++) {
      for (let s = 1; s < u.data.length; s++) {
        if (u.data[s][i] === null || u.data[s][i] === undefined) continue;
        const dx = u.valToPos(u.data[0][i], 'x') - u.cursor.left;
        const dy = u.valToPos(u.data[s][i], 'y') - u.cursor.top;
        if (dx * dx + dy * dy < least) [best, least] = [i, dx * dx + dy * dy];
      }
    }
    return best;
  }

  pointAt(u) {
    if (!this.isActive()) return;
    const {left, top} = u.cursor;
    const index = left < 0 ? null : this.byPoint ? this.nearestPoint(u) : u.cursor.idx;
    const told = index === null || index === undefined ? null : this.tell(index);
    if (!told) return hideTooltip();
    const box = u.over.getBoundingClientRect();
    this.index = index;
    showTooltip(this.element, box.left + left, box.top + top, ...told);
  }

  press(event) {
    const u = this.plot;
    const move = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    const zoom = {'+': 0.5, '=': 0.5, '-': 2}[event.key];
    if (move) {
      const [first, last] = [u.scales.x.min, u.scales.x.max].map(end => u.valToIdx(end));
      const from = this.index ?? first - 1;
      this.index = Math.max(first, Math.min(last, from + move * (event.shiftKey ? 20 : 1)));
      const y = u.data.slice(1).map(ys => ys[this.index]).find(v => v !== null && v !== undefined);
      u.setCursor({left: u.valToPos(u.data[0][this.index], 'x'), top: u.valToPos(y ?? this.yRange[0], 'y')});
    } else if (zoom) {
      this.zoom(zoom);
    } else if (event.key === '0') {
      this.showAll();
    } else if (event.key === 'Escape') {
      hideTooltip();
    } else {
      return;
    }
    event.preventDefault();
  }

  // About the cursor, never beyond all.
  zoom(factor) {
    const {min, max} = this.plot.scales.x;
    const log = this.options.scales.x.distr === 3;
    const [to, back] = log ? [Math.log10, v => 10 ** v] : [v => v, v => v];
    const middle = this.plot.cursor.left >= 0 ? to(this.plot.posToVal(this.plot.cursor.left, 'x')) : (to(min) + to(max)) / 2;
    const ends = [min, max].map(end => back(middle + (to(end) - middle) * factor));
    this.show(Math.max(this.full[0], ends[0]), Math.min(this.full[1], ends[1]));
  }
}
