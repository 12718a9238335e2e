// How cost grows with the size of sweeps and of meshes: time for each sample and polygon, and memory.
import {Chart} from './chart.js';
import {el, swatch, table} from './dom.js';
import {bytes, count, number, percent, rate} from './format.js';
import {color} from './theme.js';

const share = 0.1;  // by which the time of each may differ from that at the second size
const mebi = 2 ** 20;

const second = values => values[1] ?? values[0];
const departure = values => Math.max(...values.slice(1).map(value => Math.abs(value / second(values) - 1)));

const around = (values, factor) => [Math.min(...values) / factor, Math.max(...values) * factor];

// From the second size to the right, `share` below and above the value there.
function band(u, index) {
  const path = new Path2D(), value = u.data[index][0];
  const [left, right] = [second(u.data[0]), u.scales.x.max].map(x => u.valToPos(x, 'x', true));
  const [top, bottom] = [1 + share, 1 - share].map(factor => u.valToPos(factor * value, 'y', true));
  path.rect(left, top, right - left, bottom - top);
  return {fill: path, stroke: null, clip: null, band: null, gaps: null, flags: 3};
}

// lines: [[color, values, name]]; level: a value to hold them against.
function growthChart({title, aside, across, upward, sizes, lines, level, tell}) {
  const points = name => ({show: true, size: 8, width: 2, stroke: () => color(name), fill: () => color(name)});
  const flat = sizes.map(() => level);
  const chart = new Chart({
    label: `${title} over ${across}`,
    height: 260,
    x: {label: across, log: true, range: around(sizes, 1.6), size: 40},
    y: {label: upward, log: true, range: around(lines.flatMap(([, values]) => values), 2)},
    series: [
      ...(level ? [{width: 0, fill: 'neutral-wash', paths: band}, {color: 'neutral', width: 1}] : []),
      ...lines.map(([name]) => ({color: name, points: points(name)})),
    ],
    data: [sizes, ...(level ? [flat, flat] : []), ...lines.map(([, values]) => values)],
    pick: 'point',
    tell,
  });
  return el('.view', {},
      el('h4', {}, title, lines.length > 1 ? lines.map(([name, , text]) => swatch(name, text)) : null, el('span.aside', {}, aside)),
      chart.element);
}

function steadiness(values, unit) {
  const at = `${number(second(values))} ${unit} at the second size`;
  return values.length > 2 ? `${at}, then within ${percent(departure(values), 2)} of it` : at;
}

const explained = (sentence, ...views) => el('figure', {}, el('figcaption', {}, sentence), el('.views', {}, views));

const inOrder = (rows, size) => [...rows].sort((a, b) => a[size] - b[size]);
const numbers = titles => titles.map(text => ({text, number: true}));

function sweeps(rows) {
  const sizes = rows.map(r => r.samples), times = rows.map(r => r.ns_per_sample), memory = rows.map(r => r.peak_bytes);
  const tell = i => [`${count(sizes[i])} samples`, [['time', `${number(rows[i].seconds)} s`],
    ['a sample', `${number(times[i])} ns`], ['peak memory', bytes(memory[i])]]];
  const common = {across: 'samples', sizes, tell};
  return [
    explained('Sweeps of ever more samples: where the line keeps to the band, ±10 % about its value at the second size, time grows as the samples do, and flat memory means that it does not depend on them.',
        growthChart({...common, title: 'Time a sample', aside: steadiness(times, 'ns'), upward: 'ns',
          lines: [['gregory', times]], level: second(times)}),
        growthChart({...common, title: 'Peak memory', aside: `at most ${bytes(Math.max(...memory))}`, upward: 'MiB',
          lines: [['gregory', memory.map(value => value / mebi)]]})),
    table(numbers(['Samples', 'Time, s', 'Samples /s', 'Time a sample, ns', 'Of the second size’s', 'Peak memory']),
        rows.map((r, i) => [count(r.samples), number(r.seconds), rate(r.samples / r.seconds), number(times[i]),
          percent(times[i] / second(times)), bytes(memory[i])]), 'Sweeps'),
  ];
}

function meshes(rows) {
  const sizes = rows.map(r => r.polygons), times = rows.map(r => r.us_per_polygon);
  const peak = rows.map(r => r.peak_bytes / r.polygons), cache = rows.map(r => r.cache_bytes / r.polygons);
  const loading = (r, read) => r.load_seconds && read ? `${number(r.load_seconds / read)}×` : '–';
  const tell = i => [`${count(sizes[i])} polygons`, [['baking', `${number(rows[i].bake_seconds)} s`],
    ['a polygon', `${number(times[i])} µs`], ['peak memory', `${bytes(rows[i].peak_bytes)}, ${count(peak[i])} bytes a polygon`],
    ['cache', `${bytes(rows[i].cache_bytes)}, ${count(cache[i])} bytes a polygon`], ['loading over reading it', loading(rows[i], rows[i].read_new_seconds)]]];
  const common = {across: 'polygons', sizes, tell};
  return [
    explained('Knots of ever more polygons, baked: where the line keeps to the band, ±10 % about its value at the second size, time grows as the polygons do, and so does memory where it is flat.',
        growthChart({...common, title: 'Time a polygon', aside: steadiness(times, 'µs'), upward: 'µs',
          lines: [['gregory', times]], level: second(times)}),
        growthChart({...common, title: 'Memory a polygon', aside: `${count(peak.at(-1))} and ${count(cache.at(-1))} bytes at the largest`,
          upward: 'bytes', lines: [['gregory', peak, 'peak'], ['accent', cache, 'cache']]})),
    table(numbers(['Polygons', 'Bake, s', 'Time a polygon, µs', 'Of the second size’s', 'Peak memory', 'A polygon, bytes']),
        rows.map((r, i) => [count(r.polygons), number(r.bake_seconds), number(times[i]), percent(times[i] / second(times)),
          bytes(r.peak_bytes), count(peak[i])]), 'Baking'),
    table(numbers(['Polygons', 'Cache', 'A polygon, bytes', 'Load, s', 'Read into new memory, s', 'Load over it',
      'Read into memory in place, s', 'Load over it']),
        rows.map((r, i) => [count(r.polygons), bytes(r.cache_bytes), count(cache[i]), number(r.load_seconds),
          number(r.read_new_seconds), loading(r, r.read_new_seconds), number(r.read_seconds), loading(r, r.read_seconds)]),
        'Loading what was baked, beside reading its bytes'),
  ];
}

export function growthSection(result) {
  const {sweeps: samples, meshes: polygons} = result;
  return {
    title: 'How cost grows',
    content: [
      samples.length ? sweeps(inOrder(samples, 'samples')) : el('p.notice', {}, 'No sweeps measured.'),
      polygons.length ? meshes(inOrder(polygons, 'polygons')) : el('p.notice', {}, 'No meshes measured.'),
    ].flat(),
  };
}
