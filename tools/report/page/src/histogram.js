// Distributions over logarithmic bins, one chart for each depth, a line for each method.
import {Chart, steps} from './chart.js';
import {el, figure, select, swatch} from './dom.js';
import {number} from './format.js';
import {methodColor, methodTitle} from './methods.js';

const quantities = {
  step: ['step within patches', 'N'],
  edge_step: ['step across edges', 'N'],
  angle: ['angle between neighbours', 'rad'],
  error: ['error against k d n', 'N'],
};

const sum = values => values.reduce((a, b) => a + b, 0);

const mostDecades = 6, perDecade = 20;

// From where a thousandth lies below, but not too far, to the last that is not empty.
function reach(lists, edges) {
  let first = edges.length - 1, last = 0;
  for (const bins of lists) {
    const total = sum(bins);
    let below = 0;
    for (let i = 0; i < bins.length; i++) {
      below += bins[i];
      if (bins[i] > 0) last = Math.max(last, i);
      if (below > 1e-3 * total) first = Math.min(first, i);
    }
  }
  return [Math.max(1, first, last - mostDecades * perDecade), Math.max(last, first + 1)];
}

function depthChart(depth, quantity, range, most) {
  const [name, unit] = quantities[quantity];
  const edges = depth.methods[0].histograms.upper_edge;
  const shares = depth.methods.map(m => {
    const bins = m.histograms[quantity], total = sum(bins) || 1;
    const below = sum(bins.subarray(0, range[0]));
    return Array.from(bins, (value, i) => 100 * (value + (i === range[0] ? below : 0)) / total);
  });
  const chart = new Chart({
    label: `Distribution of the ${name}, ${depth.name} deep`,
    height: 220,
    x: {label: `${name}, ${unit}`, log: true, range: [edges[range[0] - 1], edges[range[1]]], size: 40},
    y: {label: '% of neighbours', range: [0, most]},
    series: depth.methods.map(m => ({color: methodColor(m.method), fill: `${methodColor(m.method)}-wash`, paths: steps})),
    data: [Array.from(edges), ...shares],
    tell: i => [`${i > range[0] ? `${number(edges[i - 1])} to` : 'up to'} ${number(edges[i])} ${unit}`, depth.methods.map(
        (m, k) => [methodTitle(m.method), `${number(shares[k][i])} %`, methodColor(m.method)])],
  });
  return el('.view', {}, el('h4', {}, `${depth.name.replace('mm', ' mm')} deep`), chart.element);
}

export function histograms(result) {
  const charts = el('.views');
  const show = quantity => {
    const lists = result.depths.flatMap(d => d.methods.map(m => m.histograms[quantity]));
    const range = reach(lists, result.depths[0].methods[0].histograms.upper_edge);
    const largest = bins => Math.max(sum(bins.subarray(0, range[0] + 1)), ...bins.subarray(range[0] + 1));
    const most = 1.08 * Math.max(...lists.map(bins => 100 * largest(bins) / (sum(bins) || 1)));
    charts.replaceChildren(...result.depths.map(d => depthChart(d, quantity, range, most)));
  };
  show('edge_step');
  return [
    el('.controls', {},
        select('Distribution of the', Object.entries(quantities).map(([key, [name]]) => [key, name]), 'edge_step', show),
        el('.key', {}, result.depths[0].methods.map(m => swatch(methodColor(m.method), methodTitle(m.method))))),
    figure('How much neighbouring samples differ: the further left, the smoother. 20 bins for each factor of ten; the first also holds all that is smaller.', charts),
  ];
}
