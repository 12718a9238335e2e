// A path that gliss trace followed: how much the force changes from tick to tick, a chart for each method, and the force.
import {bars, Chart, holds, joined} from './chart.js';
import {button, el, figure, select, swatch, table, uniqueId} from './dom.js';
import {count, number, vector} from './format.js';
import {inOrder, methodColor, methodTitle} from './methods.js';

// The index of the entry nearest to a value in a sorted list.
function nearest(values, value) {
  let low = 0, high = values.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low > 0 && value - values[low - 1] < values[low] - value ? low - 1 : low;
}

class PathCharts {
  constructor(result) {
    this.methods = inOrder(result.methods);
    this.range = [result.first_step - 0.5, result.last_step + 0.5];
    this.unit = result.origin.unit || 'units of the file';
    this.element = el('.charts');
    this.log = false;
    this.build();
  }

  // The scale of an axis is fixed when a chart is made.
  build() {
    const sync = uniqueId();
    this.changes = this.methods.map(method => new Chart({
      label: `Change of force from tick to tick, ${methodTitle(method.method)}`,
      height: 152,
      x: {range: this.range, size: 22},
      y: {label: 'N', log: this.log, range: this.heights(...this.range)},
      series: [{fill: methodColor(method.method), width: 0, paths: bars}],
      data: [method.step, method.change],
      tell: index => this.tell(method, index),
      onRange: (from, to) => this.show(from, to),
      sync,
    }));
    const plots = [{key: 'force', unit: 'N', label: 'Force along the path', title: 'Force, |F|'}];
    if (this.methods[0].cone_share) {
      plots.push({key: 'cone_share', unit: '', label: 'Share of the friction cone along the path',
        title: 'Share of the friction cone: the tangential force over what holds at rest'});
    }
    this.plots = plots.map(plot => ({...plot, chart: this.lines(plot, sync)}));
    this.element.replaceChildren(...this.methods.map((method, i) => el('.strip', {},
        el('h4', {}, swatch(methodColor(method.method), methodTitle(method.method)),
            el('span.aside', {}, `mean ${number(method.mean_change)} N, largest `,
                `${number(method.largest[0]?.change ?? 0)} N, jumps ${number(method.jumps_per_100k)} and lost ${
                number(method.lost_per_100k)} per 100\u202f000 ticks in contact`)),
        this.changes[i].element)), ...this.plots.map(plot => this.strip(plot)));
  }

  // A chart with a line for each method.
  lines({key, label, unit}, sync) {
    const data = joined(this.methods.map(({step, [key]: values}) => [step, values]));
    return new Chart({
      label,
      height: 220,
      x: {label: 'tick', range: this.range},
      y: {label: unit, range: this.lineHeights(key, ...this.range)},
      series: this.methods.map(({method}) => ({color: methodColor(method), paths: holds})),
      data,
      tell: index => [`Tick ${count(data[0][index])}`, this.rowsAt(data[0][index], key, unit)],
      onRange: (from, to) => this.show(from, to),
      sync,
    });
  }

  strip({title, chart}) {
    const names = this.methods.map(({method}) => swatch(methodColor(method), methodTitle(method)));
    return el('.strip', {}, el('h4', {}, title, el('span.aside.key', {}, names)), chart.element);
  }

  // The least, of those above 0, and the largest in sight of all methods: they share an axis.
  extent(key, from, to) {
    let most = 0, least = Infinity;
    for (const {step, [key]: values} of this.methods) {
      for (let i = nearest(step, from); i < step.length && step[i] <= to; i++) {
        if (step[i] < from) continue;
        most = Math.max(most, values[i]);
        if (values[i] > 0) least = Math.min(least, values[i]);
      }
    }
    return [least, most];
  }

  lineHeights(key, from, to) { return [0, 1.05 * this.extent(key, from, to)[1] || 1]; }

  heights(from, to) {
    const [least, most] = this.extent('change', from, to);
    if (!(most > 0)) return this.log ? [1e-6, 1] : [0, 1];
    if (this.log) return [10 ** Math.max(Math.floor(Math.log10(least)), Math.floor(Math.log10(most)) - 6), 10 ** Math.ceil(Math.log10(most))];
    return [0, 1.05 * most];
  }

  show(from, to) {
    const range = this.heights(from, to);
    for (const chart of [...this.changes, ...this.plots.map(plot => plot.chart)]) chart.show(from, to);
    for (const chart of this.changes) chart.setHeight(range);
    for (const {key, chart} of this.plots) chart.setHeight(this.lineHeights(key, from, to));
  }

  // What each method has at a tick.
  rowsAt(tick, key, unit = 'N') {
    return this.methods.map(({method, step, [key]: values}) => {
      const i = nearest(step, tick);
      return [methodTitle(method), step[i] === tick ? `${number(values[i])} ${unit}` : 'not shown', methodColor(method)];
    });
  }

  tell(method, index) {
    const step = method.step[index], rows = this.rowsAt(step, 'change');
    const at = [method.x[index], method.y[index], method.z[index]];
    return [`Tick ${count(step)}`, [...rows, [`|F| ${methodTitle(method.method).toLowerCase()}`, `${number(method.force[index])} N`],
      ['face', String(method.patch[index])], ['HIP', `${vector(at)} ${this.unit}`]]];
  }

  goTo(step) {
    const half = Math.max(20, (this.range[1] - this.range[0]) / 60);
    this.show(Math.max(this.range[0], step - half), Math.min(this.range[1], step + half));
  }
}

function figures(methods, charts, unit) {
  const peak = ({step, change}) => button(`${number(change)} N`, `Show tick ${count(step)}`, () => charts.goTo(step));
  const header = [{text: 'Method'}, {text: 'Mean step, N', number: true},
    ...[1, 2, 3].map(i => ({text: `${['Largest', '2nd', '3rd'][i - 1]} step`, number: true})),
    {text: 'Jumps /100k', number: true}, {text: 'Lost /100k', number: true}, {text: 'Unsound', number: true},
    {text: 'Largest force, N', number: true}, {text: `Deepest, ${unit}`, number: true}, {text: 'Ticks', number: true}, {text: 'In contact', number: true}];
  return table(header, methods.map(m => [
    swatch(methodColor(m.method), methodTitle(m.method)), number(m.mean_change),
    ...[0, 1, 2].map(i => m.largest[i] ? peak(m.largest[i]) : '–'), number(m.jumps_per_100k), number(m.lost_per_100k),
    count(m.unsound), number(m.largest_force), number(m.deepest), count(m.ticks),
    count(m.in_contact),
  ]), 'Steps of force along the path; a step leads to its tick. Jumps: ticks whose step is above 20 % of the force held lately; lost: contacts that end under more than that; each per 100 000 ticks in contact');
}

export function traceSection(result) {
  const charts = new PathCharts(result);
  const shown = charts.methods.map(m => m.step.length), bars = Math.max(...shown);
  const all = Math.max(...charts.methods.map(m => m.in_contact));
  const depths = charts.methods.map(m => m.deepest).filter(depth => depth !== null);
  const thinned = all > 1000 && bars < 0.95 * all
      ? `${count(bars)} of ${count(all)} ticks are drawn, the least and the largest of each stretch. ` : '';
  return {
    title: 'Force along a path',
    facts: depths.length ? [['Depth', `at most ${number(Math.max(...depths))} ${charts.unit}`]] : [],
    content: [
      el('.controls', {},
          select('Axis', [['linear', 'linear'], ['log', 'logarithmic']], 'linear', value => {
            charts.log = value === 'log';
            charts.build();
          }),
          button('Show all', 'Show the whole path', () => charts.show(...charts.range))),
      figure(`|F(i) − F(i−1)|, newtons: what the force changes by from one tick to the next, one axis for all methods. ${
        thinned}A tick has a bar where it or the one before it is in contact: gaining and losing contact are steps from zero and to zero. Below them is the force itself at those ticks. Drag to zoom, double-click to see all.`,
      charts.element),
      figures(charts.methods, charts, charts.unit),
    ],
  };
}
