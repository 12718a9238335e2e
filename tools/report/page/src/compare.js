// What gliss compare found: what smoothness costs in time and memory, and the dense mesh that would do as well.
import {Chart, floorBelow} from './chart.js';
import {el, figure, select, swatch, table} from './dom.js';
import {bytes, capital, count, millimetres, number, percent, rate} from './format.js';
import {methodColor, methodTitle} from './methods.js';
import {chiefRow, groupColor, grouped, groupOf, groupTitle, rowName, sameRow, sharedKeys, shortName, variedKeys} from './rows.js';
import {surfaceFigure} from './surface.js';
import {color} from './theme.js';

const across = {
  tick: ['tick, µs', row => row.tick_us],
  eval: ['evaluation, µs', row => row.eval_per_s && 1e6 / row.eval_per_s],
  memory: ['memory a patch, bytes', row => row.bytes_per_patch],
};
const upward = {
  error: ['largest error of force, share of k d', row => row.max_force_error],
  jumps: ['jumps per 100 000 ticks', row => row.jumps_per_100k],
  step: ['largest step of force, N', row => row.max_force_step],
  distance: ['largest distance, mm', row => row.max_distance && 1e3 * row.max_distance],
};

// Points that no other beats in both, from left to right.
function front(points) {
  let least = Infinity;
  return points.filter(({y}) => y < least && ((least = y), true));
}

function span(values) {
  const least = Math.min(...values), most = Math.max(...values);
  return [least / 1.4, most * 1.4];
}

function paretoChart(result, xKey, yKey) {
  const [[xLabel, xOf], [yLabel, yOf]] = [across[xKey], upward[yKey]];
  const all = result.rows.map(row => ({row, x: xOf(row), y: yOf(row)}));
  const points = all.filter(({x, y}) => x > 0 && y >= 0 && y !== null).sort((a, b) => a.x - b.x || a.y - b.y);
  if (!points.length) return el('p.notice', {}, 'Not measured: choose other axes.');
  const best = new Set(front(points));
  const positive = points.map(p => p.y).filter(y => y > 0);
  const heights = span(positive.length ? positive : [1]);
  const zero = positive.length < points.length ? floorBelow(heights[0]) : undefined;
  const place = ({y}) => y || zero;
  const column = keep => points.map(p => keep(p) ? place(p) : null);
  const dots = (size, stroke, fill) => (
      {show: true, size, width: 2, stroke: () => color(stroke), fill: () => fill ? color(fill) : 'transparent'});
  const isRecommended = ({row}) => sameRow(row, result.recommended);
  const ofGroup = (group, pareto) => column(({row}) => groupOf(row) === group && Boolean(row.pareto) === pareto);
  const groups = grouped(result.rows).map(([group]) => group);
  // What decides has its label first: the others give way.
  const rank = p => (isRecommended(p) ? 0 : 2) + (p.row.pareto ? 0 : 1);
  const chart = new Chart({
    label: `${yLabel} over ${xLabel}`,
    height: 380,
    x: {label: xLabel, log: true, range: span(points.map(p => p.x)), size: 40},
    y: {label: yLabel, log: true, range: [zero ?? heights[0], heights[1]], zero},
    series: [
      {color: 'neutral', spanGaps: true},
      ...groups.flatMap(group => [{width: 0, points: dots(8, groupColor(group), 'paper')},
        {width: 0, points: dots(10, groupColor(group), groupColor(group))}]),
      {width: 0, points: dots(19, 'accent', null)},
    ],
    data: [points.map(p => p.x), column(p => best.has(p)), ...groups.flatMap(group => [ofGroup(group, false), ofGroup(group, true)]),
      column(isRecommended)],
    labels: points.map((p, i) => [i, p]).sort(([, a], [, b]) => rank(a) - rank(b)).map(([i, p]) => [i, place(p), shortName(p.row, result.rows)]),
    pick: 'point',
    tell: i => [rowName(points[i].row), tellRow(points[i].row)],
  });
  return chart.element;
}

// Its colours.
function groupKey(rows) {
  return el('.key', {}, grouped(rows).map(([group]) => swatch(groupColor(group), groupTitle(group))));
}

function tellRow(row) {
  return [
    ['tick', `${number(row.tick_us)} µs`], ['evaluations', `${rate(row.eval_per_s)} /s`],
    ['memory a patch', bytes(row.bytes_per_patch)], ['error of force', percent(row.max_force_error)],
    ['step of force', `${number(row.max_force_step)} N, p99 ${number(row.p99_force_step)} N`],
    ['step in walks', `${number(row.walk_max_force_step)} N`],
    ['jumps, lost /100k', `${number(row.jumps_per_100k)}, ${number(row.lost_per_100k)}`],
    ['slides, gain of loops', `${percent(row.settling_share)}, ${percent(row.loop_gain)}`],
    ['distance', row.max_distance === null ? '–' : `${number(1e6 * row.max_distance)} µm`],
    ['normals apart', row.max_normal_gap_deg === null ? '–' : `${number(row.max_normal_gap_deg)}°`],
  ];
}

const micro = value => value === null ? null : 1e6 * value;
const milli = value => value === null || value === undefined ? null : 1e-3 * value;

// What decides comes first: a narrow window shows the rest only when scrolled.
const numbers = [
  ['Tick, µs', r => number(r.tick_us)], ['Force error', r => percent(r.max_force_error)],
  ['Jumps /100k', r => number(r.jumps_per_100k)], ['Lost /100k', r => number(r.lost_per_100k)],
  ['Gain of loops', r => percent(r.loop_gain)], ['Slides', r => percent(r.settling_share)],
  ['Step in walks, N', r => number(r.walk_max_force_step)], ['Unsound', r => count(r.unsound)],
  ['Force step, N', r => number(r.max_force_step)], ['Force step p99, N', r => number(r.p99_force_step)],
  ['Force error p99', r => percent(r.p99_force_error)], ['Bytes a patch', r => count(r.bytes_per_patch)],
  ['Distance, µm', r => number(micro(r.max_distance))], ['Distance p99, µm', r => number(micro(r.p99_distance))],
  ['Normal gap, °', r => number(r.max_normal_gap_deg)], ['Normal gap p99, °', r => number(r.p99_normal_gap_deg)],
  ['Build /s', r => rate(r.build_per_s)], ['Eval /s', r => rate(r.eval_per_s)], ['Track /s', r => rate(r.track_per_s)],
];

// Both constructions and the baselines, a column each; null where there is but one construction.
function sideBySide({rows, picture}) {
  const groups = grouped(rows);
  if (!['fair', 'paper'].every(group => groups.some(([name]) => name === group))) return null;
  const chosen = groups.map(([group, of]) => [group, chiefRow(of)]);
  const pictureOf = group => Array.isArray(picture) ? picture.find(p => p.construction === group) : undefined;
  const lines = numbers.slice(0, 9).map(([text, of]) => [text, ...chosen.map(([, row]) => of(row))]);
  if (Array.isArray(picture)) {
    const bends = [['Curvature p50, 1/mm', 'p50_curvature'], ['Curvature p99, 1/mm', 'p99_curvature'], ['Curvature, 1/mm', 'max_curvature']];
    lines.push(...bends.map(([text, key]) => [text, ...chosen.map(([group]) => number(milli(pictureOf(group)?.[key])))]));
  }
  const header = [{text: 'Figure'}, ...chosen.map(([group, row]) => ({text: swatch(groupColor(group), groupTitle(group)), title: rowName(row), number: true}))];
  return table(header, lines, `Side by side: ${chosen.map(([group, row]) => `${groupTitle(group)}: ${rowName(row)}`).join('; ')}`);
}

function rowTable(result) {
  const shared = sharedKeys(result.rows);
  const header = [...[capital(variedKeys(result.rows).join(', ')), ...shared.map(capital)].map(text => ({text})),
    ...numbers.map(([text]) => ({text, number: true})), {text: 'Surface'}];
  const rows = grouped(result.rows).flatMap(([group, of]) => of.map(r => Object.assign(
      [swatch(groupColor(group), shortName(r, result.rows)), ...shared.map(key => String(r[key] ?? '–')),
        ...numbers.map(([, show]) => show(r)), groupTitle(group)],
      {mark: sameRow(r, result.recommended) ? 'recommended' : r.pareto ? 'best' : ''})));
  return table(header, rows, 'All that was compared; bold: not beaten in every figure by another; marked: recommended');
}

// Says where jumps and lost contacts were counted; tables are too wide for it.
function countedWhere({walks}) {
  const where = walks ? `in ${count(walks.walkers)} random walks of ${count(walks.ticks)} ticks, ${number(1e3 * walks.depth_m)} mm deep` : 'along the path';
  return el('p.notice', {}, `Jumps are ticks whose force changes by more than 20 % of stiffness times depth; lost are contacts that end under more than that. Both are counted ${where}, per 100\u202f000 ticks in contact.`);
}

function denseTable(result) {
  if (!result.dense.length) return null;
  const header = [{text: 'Method'}, {text: 'As smooth as'},
    ...['Triangles', 'Memory', 'Patches’ memory', 'Memory ratio', 'Tick, µs', 'Patches’ tick, µs', 'Time ratio', 'Force step p99, N', 'Force step, N',
     'Jumps /100k', 'Lost /100k']
        .map(text => ({text, number: true})), {text: 'Reached'}];
  const times = ratio => ratio === null ? '–' : `${number(ratio)}×`;
  const rows = result.dense.map(d => [
    swatch(methodColor(d.method), methodTitle(d.method)), String(d.target ?? '–'), count(d.triangles), bytes(d.bytes),
    bytes(d.target_bytes), times(d.memory_ratio), number(d.tick_us), number(d.target_tick_us), times(d.time_ratio),
    number(d.p99_force_step), number(d.max_force_step), number(d.jumps_per_100k), number(d.lost_per_100k), d.reached === null ? '–' : d.reached ? 'yes' : 'no: the densest tried',
  ]);
  return table(header, rows, 'The dense triangle mesh that flat polygons or force shading need to be as smooth');
}

export function compareSection(result) {
  const place = el('.charts');
  let [x, y] = ['tick', 'error'];
  const show = () => place.replaceChildren(paretoChart(result, x, y));
  show();
  const choices = list => Object.entries(list).map(([key, [label]]) => [key, label]);
  const {recommended} = result;
  return {
    title: 'Levels, precisions and backends compared',
    facts: [
      ...(Array.isArray(result.depths_m) ? [['Depth', result.depths_m.map(millimetres).join(', ')]] : []),
      ...(recommended && typeof result.reason === 'string' ? [['Recommended', `${rowName(recommended)}: ${result.reason}`]] : []),
    ],
    content: [
      el('.controls', {}, select('Across', choices(across), x, value => ((x = value), show())),
          select('Upward', choices(upward), y, value => ((y = value), show())),
          recommended ? el('span.named', {}, el('span.swatch.ring'), `recommended: ${rowName(recommended)}`) : null),
      figure('What accuracy costs: left is cheaper, down is better. Filled points are beaten by no other in every figure at once; the line joins those that none beats on these two axes. What is 0, which a logarithmic axis has not, lies on the dashed line.', groupKey(result.rows), place),
      sideBySide(result), surfaceFigure(result), rowTable(result), countedWhere(result), denseTable(result),
    ].flat().filter(Boolean),
  };
}
