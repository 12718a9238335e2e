// The surface of each construction, coloured by how much it bends or how far it departs from the polygons, and marked where random walks jump.
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

// A bar of all colours. marks: [share of its length, text, kind].
function legend(label, aside, marks) {
  const bar = el('.bar', {});
  bar.style.background = `linear-gradient(to right, ${ramp.join(', ')})`;
  const made = marks.map(([share, text, kind]) => {
    const mark = el(`span.${kind}`, {}, text);
    mark.style.left = `${100 * share}%`;
    return mark;
  });
  const deep = marks.some(([, , kind]) => kind === 'depth');
  return el(deep ? '.scale.deep' : '.scale', {role: 'img', 'aria-label': label},
      el('.track', {}, bar, ...made), el('.aside', {}, aside));
}

// The colours with their curvatures, and the one whose radius is the depth of the walks.
function curvatureColors(pictures, depth) {
  const {low, high} = scaleOf(pictures), place = curvature => Math.log(curvature / low) / Math.log(high / low);
  const marks = [];
  // Powers of ten, and twice and five times those where they are few.
  const times = high < 100 * low ? [1, 2, 5] : [1];
  for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e++) {
    for (const curvature of times.map(factor => factor * 10 ** e)) {
      if (curvature > 0.999 * low && curvature < 1.001 * high) marks.push([place(curvature), power(1e-3 * curvature), 'mark']);
    }
  }
  if (depth && 1 / depth >= low && 1 / depth <= high) marks.push([place(1 / depth), '1 / depth', 'depth']);
  return {of: p => p.curvature.map(place),
    legend: legend(`Colours of curvature from ${perMm(low)} to ${perMm(high)}`, 'largest curvature of a face, 1/mm', marks)};
}

// The colours with the distances from the polygons.
function departureColors(pictures) {
  const most = Math.max(...pictures.map(p => p.departure.reduce((a, b) => Math.max(a, b), 0))) || 1;
  const marks = [0, 0.25, 0.5, 0.75, 1].map(share => [share, number(1e3 * share * most), 'mark']);
  return {of: p => p.departure.map(d => d / most),
    legend: legend(`Colours of departure up to ${number(1e3 * most)} mm`, `departure from the polygons, at most ${number(1e3 * most)} mm`, marks)};
}

function tellPoint(pictures, i) {
  const rows = pictures.map(p => [groupTitle(p.construction),
    `${perMm(p.curvature[i])}, radius ${number(1e3 / p.curvature[i])} mm${p.departure ? `; departs by ${number(1e3 * p.departure[i])} mm` : ''}`,
    groupColor(p.construction)]);
  return [`Face ${pictures[0].face[i]}`, rows];
}

function tellJump({position, face, step, lost}, i, unit) {
  return [`Jump on face ${face[i]}`, [['step', `${percent(step[i])} of k d`], ['contact', lost[i] ? 'lost' : 'kept'],
    ['at', `${vector(position.subarray(3 * i, 3 * i + 3))} ${unit || ''}`]]];
}

class SurfaceView {
  constructor(picture, row, orbit) {
    this.picture = picture;
    this.own = row;
    this.heat = new BufferAttribute(new Float32Array(picture.face.length), 1);
    this.canvas = el('canvas', {tabindex: '0', role: 'img', 'data-view': `surface/${picture.construction}`,
      'aria-label': `Surface and curvature, ${groupTitle(picture.construction)}. ${keysHint}`});
    const points = {positions: new BufferAttribute(picture.position, 3), spacing: new BufferAttribute(picture.spot, 1),
      heat: this.heat};
    this.view = new CloudView(this.canvas, points, picture.normal, orbit);
    this.about = el('span.aside');
    this.element = el('.view', {}, el('h4', {}, swatch(groupColor(picture.construction), groupTitle(picture.construction)), this.about), this.canvas);
  }

  // Colours of departureColors or the like; null: lit by a lamp.
  color(colors) {
    this.view.material.uniforms.heated.value = colors !== null;
    if (colors) {
      this.heat.array.set(colors.of(this.picture).map(heat => Math.min(1, Math.max(0, heat)) || 0));
      this.heat.needsUpdate = true;
    }
    this.view.ask();
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
  const groups = Object.fromEntries(grouped(rows)), colors = {curvature: curvatureColors(pictures, walks?.depth_m), lit: null};
  if (pictures.every(p => p.departure)) colors.departure = departureColors(pictures);
  const views = [];
  const orbit = new Orbit(new Box3().setFromArray(pictures[0].position), () => views.forEach(({view}) => view.ask()));
  const point = index => views.forEach(({view}) => view.marked !== index && ((view.marked = index), view.ask()));
  for (const picture of pictures) {
    const made = new SurfaceView(picture, groups[picture.construction] && chiefRow(groups[picture.construction]), orbit);
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
  const legends = el('div');
  const color = by => {
    legends.replaceChildren((colors[by] ?? colors.curvature).legend);
    legends.hidden = !colors[by];
    views.forEach(view => view.color(colors[by]));
  };
  color('curvature');
  const choices = [['own', 'each construction’s own'], ['', 'none'],
    ...rows.map((row, i) => [String(i), row]).filter(([, row]) => row.jumps).map(([i, row]) => [i, `${rowName(row)}: ${count(row.jumps.step.length)}`])];
  const depth = walks && `${number(1e3 * walks.depth_m)} mm`;
  return [
    el('.controls', {},
        select('Jumps of', choices, 'own', show),
        select('Surface', [['curvature', 'by curvature'], ...colors.departure ? [['departure', 'by departure']] : [], ['lit', 'lit by a lamp']],
            'curvature', color),
        button('Reset view', 'All of the surface', () => orbit.reset())),
    figure([`The surface of each construction, ${count(pictures[0].points)} points of it; the colour is the largest curvature of the face there, or how far the point is from the polygons, on one scale. ${
        depth ? `Where the radius of curvature is below the depth of the walks, ${depth}, the nearest point of a HIP may leap. ` : ''}Dots are places that the force jumps at on random walks, the larger the step the larger; of very many, the 200 largest. The cameras are linked. Drag turns, shift-drag moves, the wheel zooms once a view is clicked.`],
    legends, el('.views', {}, views.map(view => view.element))),
  ];
}
