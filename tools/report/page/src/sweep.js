// What gliss sweep sampled: forces over the offset surfaces, one view for each depth and method, and how they differ.
import {Box3, BufferAttribute} from 'three';
import {CloudView, spacings, startClouds} from './cloud.js';
import {button, el, figure, select, swatch, table} from './dom.js';
import {count, number, vector} from './format.js';
import {histograms} from './histogram.js';
import {inOrder, methodColor, methodTitle} from './methods.js';
import {Orbit, keysHint} from './orbit.js';
import {hideTooltip, showTooltip} from './tooltip.js';

const depthText = depth => depth.name.replace('mm', ' mm');

// Degrees between two forces; NaN where there is none.
function angle(a, b, i) {
  let [dot, aa, bb] = [0, 0, 0];
  for (let k = 3 * i; k < 3 * i + 3; k++) [dot, aa, bb] = [dot + a[k] * b[k], aa + a[k] ** 2, bb + b[k] ** 2];
  return Math.acos(Math.min(1, dot / Math.sqrt(aa * bb))) * 180 / Math.PI;
}

function tellPoint(depth, i, unit) {
  const force = method => method.force.subarray(3 * i, 3 * i + 3);
  const reference = depth.methods.find(m => m.method === 'gregory');
  const rows = depth.methods.map(m => {
    const turned = reference && m !== reference ? angle(m.force, reference.force, i) : NaN;
    const size = `${number(Math.hypot(...force(m)))} N`;
    return [methodTitle(m.method), Number.isNaN(turned) ? size : `${size}, ${number(turned, 2)}° off`, methodColor(m.method)];
  });
  const at = depth.hip.subarray(3 * i, 3 * i + 3);
  return [`Patch ${depth.patch[i]}, ${depthText(depth)} deep`, [...rows, ['HIP', `${vector(at)} ${unit || ''}`]]];
}

// The views of one depth: what is pointed at in one is marked in all.
function depthViews(depth, orbit, unit) {
  const points = {positions: new BufferAttribute(depth.hip, 3),
                  spacing: new BufferAttribute(spacings(depth.hip, depth.patch), 1)};
  const views = [];
  const point = index => {
    for (const view of views) {
      if (view.marked === index) continue;
      view.marked = index;
      view.ask();
    }
  };
  const boxes = depth.methods.map(method => {
    const canvas = el('canvas', {tabindex: '0', role: 'img', 'data-view': `${depth.name}/${method.method}`,
      'aria-label': `Directions of force, ${methodTitle(method.method)}, ${depthText(depth)} deep. ${keysHint}`});
    const view = new CloudView(canvas, points, method.force, orbit);
    views.push(view);
    orbit.listen(canvas);
    canvas.addEventListener('pointermove', event => {
      const index = event.buttons ? null : view.pick(event.offsetX, event.offsetY);
      point(index);
      if (index === null) return hideTooltip();
      showTooltip(canvas, event.clientX, event.clientY, ...tellPoint(depth, index, unit));
    });
    canvas.addEventListener('pointerleave', () => (point(null), hideTooltip()));
    return el('.view', {},
        el('h4', {}, swatch(methodColor(method.method), methodTitle(method.method)),
            el('span.aside', {}, `${depthText(depth)} deep, largest step across edges ${number(method.statistics.edge_step.max)} N, jumps ${
                number(method.statistics.jumps_per_100k)} and lost ${number(method.statistics.lost_per_100k)} per 100\u202f000 pairs`)),
        canvas);
  });
  return {views, element: el('.views', {}, boxes)};
}

function surfaceFigure(result) {
  const unit = result.origin.unit;
  if (!startClouds()) return el('p.notice', {}, 'This browser has no WebGL: the surfaces are not shown.');
  const views = [];
  const box = new Box3().setFromArray(result.depths[0].hip);
  const orbit = new Orbit(box, () => views.forEach(view => view.ask()));
  const depths = result.depths.map(depth => {
    const made = depthViews(depth, orbit, unit);
    views.push(...made.views);
    return made.element;
  });
  const {shown, samples} = result.depths[0];
  const some = shown < samples ? `${count(shown)} of ${count(samples)} points a depth` : `${count(samples)} points a depth`;
  return [
    el('.controls', {},
        select('Shading', [['lit', 'lit by a lamp'], ['direction', 'direction as colour']], 'lit', value => {
          for (const view of views) {
            view.material.uniforms.direction.value = value === 'direction';
            view.ask();
          }
        }),
        button('Reset view', 'All of the surface', () => orbit.reset())),
    figure([`Points of the surface offset inward, lit as if the direction of the force were the normal: a smooth force looks smooth, an edge in the picture is an edge in the hand. ${some}; the cameras are linked. Drag turns, shift-drag moves, the wheel zooms once a view is clicked. `,
      el('span.swatch.free'), ' no force: flat polygons and force shading feel none where a HIP is beneath the patches but outside the polygons.'], ...depths),
  ];
}

function statistics(result) {
  const of = (h, name) => number(h[name]), neighbours = 'Neighbours /100k';
  const header = [{text: 'Method, depth'},
    ...['mean', 'p99', 'largest'].map(text => ({text, title: 'step within patches, N', number: true, group: 'Step within patches, N'})),
    ...['mean', 'p99', 'largest'].map(text => ({text, title: 'step across edges, N', number: true, group: 'Step across edges, N'})),
    {text: 'jumps', title: 'pairs whose step is above 20 % of k d, per 100 000 in contact', number: true, group: neighbours},
    {text: 'lost', title: 'pairs of which one is free and the other has more than 20 % of k d, per 100 000 in contact', number: true, group: neighbours},
    {text: 'leaps', title: 'jumps of more than twice the way between the HIPs besides, per 100 000 in contact', number: true, group: neighbours},
    {text: 'unsound', title: 'steps that are not finite', number: true},
    {text: 'p99', title: 'angle between neighbours, degrees', number: true, group: 'Angle, degrees'},
    {text: 'largest', title: 'angle between neighbours, degrees', number: true, group: 'Angle, degrees'},
    {text: 'largest', title: 'error against k d n, N', number: true, group: 'Error, N'},
    {text: 'touching', title: 'share of the samples with a force', number: true}];
  const degrees = radians => number(radians * 180 / Math.PI);
  const unsound = s => s.step.unsound === null ? null : s.step.unsound + s.edge_step.unsound;
  const rows = result.depths.flatMap(depth => depth.methods.map(({method, statistics: s}) => [
    swatch(methodColor(method), `${methodTitle(method)}, ${depthText(depth)}`),
    of(s.step, 'mean'), of(s.step, 'p99'), of(s.step, 'max'),
    of(s.edge_step, 'mean'), of(s.edge_step, 'p99'), of(s.edge_step, 'max'),
    number(s.jumps_per_100k), number(s.lost_per_100k), number(s.leaps_per_100k), count(unsound(s)),
    degrees(s.angle.p99), degrees(s.angle.max), of(s.error, 'max'),
    `${number(100 * s.touching / s.samples, 4)} %`,
  ]));
  return table(header, rows, `Neighbouring samples, ${count(result.depths[0].samples)} a depth. A sweep has no time: a step is one from a sample to its neighbour, and where one of them is free, its force is zero.`);
}

export function sweepSection(result) {
  for (const depth of result.depths) depth.methods = inOrder(depth.methods);
  return {
    title: 'Force over the surface',
    facts: [['Depth', result.depths.map(depthText).join(', ')]],
    content: [surfaceFigure(result), histograms(result), statistics(result)].flat(),
  };
}
