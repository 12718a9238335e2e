// The surface of each construction, coloured by how much it bends, and marked where random walks jump.
import {Box3, BufferAttribute} from 'three';
import {CloudView, ramp, startClouds} from './cloud.js';
import {button, el, figure, select, swatch} from './dom.js';
import {count, number, percent, power, vector} from './format.js';
import {Orbit, keysHint} from './orbit.js';
import {chiefRow, grouped, groupColor, groupTitle, rowName} from './rows.js';
import {hideTooltip, showTooltip} from './tooltip.js';

const perMm = curvature => curvature === null ? '–' : `${number(1e-3 * curvature)} /mm`;

// Curvatures from the least to the largest that have a colour of their own, 1/m: those few beyond share the last.
function scaleOf(pictures) {
  const values = Float32Array.from(pictures.flatMap(p => Array.from(p.curvature)).filter(k => k > 0 && k < Infinity)).sort();
  if (!values.length) return {low: 1, high: 10};
  const low = values[Math.floor(0.01 * values.length)], high = values[Math.floor(0.999 * values.length)];
  return {low, high: Math.max(high, 10 * low)};
}

const place = ({low, high}, curvature) => Math.log(curvature / low) / Math.log(high / low);

// The colours with their curvatures, and the one whose radius is the depth of the walks.
function legend(scale, depth) {
  const at = (curvature, text, kind) => {
    const made = el(`span.${kind}`, {}, text);
    made.style.left = `${100 * place(scale, curvature)}%`;
    return made;
  };
  const marks = [];
  // Powers of ten, and twice and five times those where they are few.
  const times = scale.high < 100 * scale.low ? [1, 2, 5] : [1];
  for (let e = Math.floor(Math.log10(scale.low)); e <= Math.log10(scale.high); e++) {
    for (const curvature of times.map(factor => factor * 10 ** e)) {
      if (curvature > 0.999 * scale.low && curvature < 1.001 * scale.high) marks.push(at(curvature, power(1e-3 * curvature), 'mark'));
    }
  }
  const deep = depth && 1 / depth >= scale.low && 1 / depth <= scale.high;
  if (deep) marks.push(at(1 / depth, '1 / depth', 'depth'));
  const bar = el('.bar', {});
  bar.style.background = `linear-gradient(to right, ${ramp.join(', ')})`;
  return el(deep ? '.scale.deep' : '.scale', {role: 'img', 'aria-label': `Colours of curvature from ${perMm(scale.low)} to ${perMm(scale.high)}`},
      el('.track', {}, bar, ...marks), el('.aside', {}, 'largest curvature of a face, 1/mm'));
}

function tellPoint(pictures, i) {
  const rows = pictures.map(p => [groupTitle(p.construction),
    `${perMm(p.curvature[i])}, radius ${number(1e3 / p.curvature[i])} mm`, groupColor(p.construction)]);
  return [`Face ${pictures[0].face[i]}`, rows];
}

function tellJump({position, face, step, lost}, i, unit) {
  return [`Jump on face ${face[i]}`, [['step', `${percent(step[i])} of k d`], ['contact', lost[i] ? 'lost' : 'kept'],
    ['at', `${vector(position.subarray(3 * i, 3 * i + 3))} ${unit || ''}`]]];
}

class SurfaceView {
  constructor(picture, row, heat, orbit) {
    this.picture = picture;
    this.own = row;
    this.canvas = el('canvas', {tabindex: '0', role: 'img', 'data-view': `surface/${picture.construction}`,
      'aria-label': `Surface and curvature, ${groupTitle(picture.construction)}. ${keysHint}`});
    const points = {positions: new BufferAttribute(picture.position, 3), spacing: new BufferAttribute(picture.spot, 1),
      heat: new BufferAttribute(heat, 1)};
    this.view = new CloudView(this.canvas, points, picture.normal, orbit);
    this.about = el('span.aside');
    this.element = el('.view', {}, el('h4', {}, swatch(groupColor(picture.construction), groupTitle(picture.construction)), this.about), this.canvas);
  }

  // The jumps of a row; null: none.
  mark(row) {
    const {p50_curvature, p99_curvature, max_curvature} = this.picture;
    const jumps = this.jumps = row?.jumps;
    const marked = jumps ? `; ${count(jumps.step.length)} ${jumps.step.length === 1 ? 'jump' : 'jumps'} marked (${rowName(row)})` : '';
    this.about.textContent = `curvature ${perMm(p50_curvature)} in the median of the faces, ${perMm(p99_curvature)} at 99 %, ${perMm(max_curvature)} at most${marked}`;
    this.view.setMarks(jumps?.position ?? new Float32Array(), Float32Array.from(jumps?.step ?? [], step => 7 + 7 * Math.min(1, step)));
  }
}

// Null where the file has no pictures.
export function surfaceFigure({picture: pictures, rows, walks, origin}) {
  if (pictures === true) return el('p.notice', {}, 'The pictures of the surface are too much beside the other results: make a page of this file alone.');
  if (!pictures?.length) return null;
  if (!startClouds()) return el('p.notice', {}, 'This browser has no WebGL: the surfaces are not shown.');
  const scale = scaleOf(pictures), groups = Object.fromEntries(grouped(rows));
  const views = [];
  const orbit = new Orbit(new Box3().setFromArray(pictures[0].position), () => views.forEach(({view}) => view.ask()));
  const point = index => views.forEach(({view}) => view.marked !== index && ((view.marked = index), view.ask()));
  for (const picture of pictures) {
    const heat = picture.curvature.map(k => Math.min(1, Math.max(0, place(scale, k))) || 0);
    const made = new SurfaceView(picture, groups[picture.construction] && chiefRow(groups[picture.construction]), heat, orbit);
    orbit.listen(made.canvas);
    made.canvas.addEventListener('pointermove', event => {
      const at = event.buttons ? {} : made.view.pickAny(event.offsetX, event.offsetY);
      point(at.point ?? null);
      if (at.mark !== undefined) return showTooltip(made.canvas, event.clientX, event.clientY, ...tellJump(made.jumps, at.mark, origin.unit));
      if (at.point === undefined) return hideTooltip();
      showTooltip(made.canvas, event.clientX, event.clientY, ...tellPoint(pictures, at.point));
    });
    made.canvas.addEventListener('pointerleave', () => (point(null), hideTooltip()));
    views.push(made);
  }
  const show = value => views.forEach(view => view.mark(value === 'own' ? view.own : rows[value]));
  show('own');
  const choices = [['own', 'each construction’s own'], ['', 'none'],
    ...rows.map((row, i) => [String(i), row]).filter(([, row]) => row.jumps).map(([i, row]) => [i, `${rowName(row)}: ${count(row.jumps.step.length)}`])];
  const depth = walks && `${number(1e3 * walks.depth_m)} mm`;
  return [
    el('.controls', {},
        select('Jumps of', choices, 'own', show),
        select('Surface', [['heat', 'by curvature'], ['lit', 'lit by a lamp']], 'heat', value => {
          for (const {view} of views) {
            view.material.uniforms.heated.value = value === 'heat';
            view.ask();
          }
        }),
        button('Reset view', 'All of the surface', () => orbit.reset())),
    figure([`The surface of each construction, ${count(pictures[0].points)} points of it; the colour is the largest curvature of the face there, on one scale. ${
        depth ? `Where the radius of curvature is below the depth of the walks, ${depth}, the nearest point of a HIP may leap. ` : ''}Dots are places that the force jumps at on random walks, the larger the step the larger; of very many, the 200 largest. The cameras are linked. Drag turns, shift-drag moves, the wheel zooms once a view is clicked.`],
    legend(scale, walks?.depth_m), el('.views', {}, views.map(view => view.element))),
  ];
}
