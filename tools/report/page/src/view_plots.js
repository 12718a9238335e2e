// What the three methods feel, over the last ten seconds: |F|, its step from tick to tick, and depth, on one axis each.
import {Chart} from './chart.js';
import {el, figure} from './dom.js';
import {number} from './format.js';
import {methodColor, methodTitle} from './methods.js';

export const methods = ['flat', 'shaded', 'gregory'];
const seconds = 10, binned = 0.02;  // s; of a bin the largest value is shown
const running = 1;  // GuardState::kRun
const bins = Math.round(seconds / binned);

const quantities = [
  {key: 'force', label: 'Force', unit: 'N', scale: 1, least: 0.5},
  {key: 'step', label: 'Step of force from tick to tick', unit: 'N', scale: 1, least: 0.05},
  {key: 'depth', label: 'Depth', unit: 'mm', scale: 1e3, least: 0.5},
];

// The processor draws them: by a graphics card that is simulated, each picture would hold up the page for half a second,
// and the hand with it. uPlot asks for its contexts without a word about that.
const {getContext} = HTMLCanvasElement.prototype;
HTMLCanvasElement.prototype.getContext = function(kind, options) {
  return getContext.call(this, kind, kind === '2d' ? {...options, willReadFrequently: true} : options);
};

// Bins by time: [method][quantity], the latest at `last`.
class History {
  constructor() {
    this.values = methods.map(() => quantities.map(() => new Float32Array(bins).fill(NaN)));
    this.last = null;
  }

  // Values of all methods at a time.
  add(time, values) {
    const bin = Math.floor(time / binned);
    if (this.last === null || bin < this.last - bins) this.last = bin - bins;
    for (; this.last < bin; this.last++) {
      for (const own of this.values) for (const list of own) list[(this.last + 1) % bins] = NaN;
    }
    values.forEach((own, m) => own.forEach((value, q) => {
      const list = this.values[m][q], at = ((bin % bins) + bins) % bins;
      if (!(list[at] >= value)) list[at] = value;
    }));
  }

  // The oldest first.
  list(m, q) {
    const from = this.values[m][q], to = new Array(bins);
    for (let i = 0; i < bins; i++) {
      const value = from[(this.last + 1 + i) % bins];
      to[i] = Number.isNaN(value) ? null : value * quantities[q].scale;
    }
    return to;
  }

  most(m, q) { return this.values[m][q].reduce((a, value) => value > a ? value : a, 0); }
}

export class Plots {
  constructor() {
    this.history = new History();
    this.before = null;
    this.paused = false;
    this.times = Array.from({length: bins}, (_, i) => (i + 1) * binned - seconds);
    this.charts = quantities.map(({key, label, unit}) => new Chart({
      label: `${label} over the last ${seconds} s`,
      height: 150,
      x: {range: [-seconds, 0]},
      y: {label: unit, range: [0, 1], size: 46},
      series: methods.map(method => ({color: methodColor(method), width: 1.4})),
      data: [this.times, ...methods.map(() => new Array(bins).fill(null))],
      sync: 'live',
      tell: i => this.tell(i),
    }));
    this.element = el('.plots', {}, this.charts.map((chart, q) =>
        figure(`${quantities[q].label}, ${quantities[q].unit}; seconds before now`, chart.element)));
  }

  tell(i) {
    const rows = methods.flatMap((method, m) => quantities.map(({label, unit}, q) => {
      const value = this.charts[q].data[m + 1][i];
      return [`${methodTitle(method)}, ${label.split(' ')[0].toLowerCase()}`, value === null ? '–' : `${number(value)} ${unit}`, methodColor(method)];
    }));
    return [`${number(-this.times[i])} s before`, rows];
  }

  // Takes the ticks of a frame, a period (s) apart where none was missed. A step is one within a contact, of one period,
  // under a guard that runs: gaining and losing contact are none, the steps of a hand that went on while the loop stood
  // still are not known, and one that feels no force falls. Gives the steps, [tick][method] in N.
  add(frame, period) {
    const all = [];
    for (let i = 0; i < frame.count; i++) {
      const tick = frame.at(i), now = {number: frame.number + i, time: frame.time + tick.since, guard: tick.guard, felt: tick.felt};
      const follows = this.before && this.before.number === now.number - 1 && now.time - this.before.time < 1.5 * period &&
          this.before.guard === running && now.guard === running;
      const steps = tick.felt.map(({force, contact}, m) => {
        const last = this.before?.felt[m];
        return follows && contact > 0 && last.contact > 0 ? Math.hypot(force[0] - last.force[0], force[1] - last.force[1], force[2] - last.force[2]) : 0;
      });
      this.history.add(now.time, tick.felt.map((felt, m) => [Math.hypot(...felt.force), steps[m], felt.depth]));
      this.before = now;
      all.push(steps);
    }
    return all;
  }

  // The largest step of each method in the window, N.
  largestSteps() { return methods.map((_, m) => this.history.most(m, 1)); }

  clear() {
    this.history = new History();
    this.before = null;
  }

  draw() {
    if (this.paused || this.history.last === null) return;
    quantities.forEach(({scale, least}, q) => {
      const most = Math.max(least, ...methods.map((_, m) => scale * this.history.most(m, q)));
      this.charts[q].update([this.times, ...methods.map((_, m) => this.history.list(m, q))], [0, 1.1 * most]);
    });
  }
}
