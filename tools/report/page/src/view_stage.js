// The scene of gliss view: surfaces, polygons, the hand and what it touches; and the place under the pointer.
import {AlwaysDepth, AmbientLight, ArrowHelper, Box2, Box3, BufferAttribute, BufferGeometry, Camera, Color, DepthTexture, DirectionalLight,
  DoubleSide, GLSL3, HalfFloatType, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Plane,
  PlaneGeometry, Raycaster, Scene, ShaderMaterial, SphereGeometry, Triangle, Vector2, Vector3, WebGLRenderer, WebGLRenderTarget} from 'three';
import {MeshBVH} from 'three-mesh-bvh';
import {ramp} from './cloud.js';
import {beforeNextPicture} from './dom.js';
import {keysHint, Orbit} from './orbit.js';
import {color, onTheme} from './theme.js';

export const kinds = [['exact', '#9fb3c8'], ['eased', '#fee090'], ['split', '#fc8d59'], ['bent', '#b2182b'], ['crease', '#7b5ea7']];

const mostMarked = 60000;  // corners of triangles of a face and its neighbours that are marked

const rgb = text => new Color().setStyle(text).toArray().map(share => Math.round(255 * share));

function heatColor(share) {
  const at = 4 * Math.min(1, Math.max(0, share)), below = Math.min(3, Math.floor(at));
  const [a, b] = [rgb(ramp[below]), rgb(ramp[below + 1])];
  return a.map((x, i) => x + (b[i] - x) * (at - below));
}

// The picture of the objects, with its depths, behind what moves.
class Backdrop {
  constructor() {
    this.target = new WebGLRenderTarget(1, 1, {type: HalfFloatType, depthTexture: new DepthTexture(1, 1)});
    const material = new ShaderMaterial({
      glslVersion: GLSL3,
      depthFunc: AlwaysDepth,
      uniforms: {picture: {value: this.target.texture}, depths: {value: this.target.depthTexture}},
      vertexShader: 'out vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: `in vec2 at;
uniform sampler2D picture, depths;
out vec4 shade;
#define gl_FragColor shade
void main() {
  shade = texture(picture, at);
  gl_FragDepth = texture(depths, at).r;
  #include <colorspace_fragment>
}`,
    });
    this.scene = new Scene();
    this.scene.add(new Mesh(new PlaneGeometry(2, 2), material));
    this.camera = new Camera();
  }
}

// The materials that all objects share.
function makeMaterials() {
  const offset = (factor, units) => ({polygonOffset: true, polygonOffsetFactor: factor, polygonOffsetUnits: units});
  return {
    surface: new MeshLambertMaterial({vertexColors: true, side: DoubleSide, ...offset(1, 1)}),
    polygons: new MeshLambertMaterial({flatShading: true, side: DoubleSide, ...offset(1, 1)}),
    edges: new LineBasicMaterial({transparent: true, opacity: 0.55}),
    touched: [0.5, 0.2].map(opacity => new MeshBasicMaterial({side: DoubleSide, transparent: true, opacity, ...offset(-1, -4)})),
  };
}

// An object's meshes, and the arrays that are picked in.
class Shown {
  constructor(geometry, materials) {
    this.data = geometry;
    const surface = new BufferGeometry();
    surface.setAttribute('position', new BufferAttribute(geometry.position, 3));
    const normals = new Int8Array(geometry.position.length);
    for (let i = 0; i < normals.length; i++) normals[i] = geometry.packed[4 * Math.floor(i / 3) + i % 3];
    surface.setAttribute('normal', new BufferAttribute(normals, 3, true));
    this.colors = new BufferAttribute(new Uint8Array(geometry.position.length), 3, true);
    surface.setAttribute('color', this.colors);
    surface.setIndex(new BufferAttribute(geometry.index, 1));
    this.surface = new Mesh(surface, materials.surface);
    const touched = new BufferGeometry();
    for (const name of ['position', 'normal']) touched.setAttribute(name, surface.getAttribute(name));
    touched.setIndex(new BufferAttribute(new Uint32Array(mostMarked), 1));
    touched.setDrawRange(0, 0);
    this.touched = new Mesh(touched, materials.touched);
    this.touchedBox = new Box3();
    const polygons = new BufferGeometry();
    polygons.setAttribute('position', new BufferAttribute(geometry.polygons, 3));
    this.polygons = new Mesh(polygons, materials.polygons);
    const edges = new BufferGeometry();
    edges.setAttribute('position', new BufferAttribute(geometry.edges, 3));
    this.edges = new LineSegments(edges, materials.edges);
    // The triangles of a face stand together.
    this.firstOfFace = new Map();
    for (let t = 0; t < geometry.index.length; t += 3) {
      const face = geometry.face[geometry.index[t]];
      if (!this.firstOfFace.has(face)) this.firstOfFace.set(face, t);
    }
    this.still = [this.surface, this.polygons, this.edges];
    this.all = [...this.still, this.touched];
    for (const mesh of this.all) mesh.frustumCulled = false;
  }

  // Gives the largest height, m, of 'height'. depth: m, that a curvature is against.
  paint(by, depth) {
    const {height, packed, face, curvature} = this.data, to = this.colors.array, clay = rgb(color('clay'));
    const most = by === 'height' ? height.reduce((a, h) => Math.max(a, Math.abs(h)), 0) || 1 : null;
    const ofKind = kinds.map(([, text]) => rgb(text));
    const shade = {
      clay: () => clay,
      kind: i => ofKind[packed[4 * i + 3]],
      height: i => heatColor(0.5 + 0.5 * height[i] / most),
      curvature: i => heatColor(depth * curvature[face[i]]),
    }[by];
    for (let i = 0; i < height.length; i++) {
      const own = shade(i);
      for (let k = 0; k < 3; k++) to[3 * i + k] = own[k];
    }
    this.colors.needsUpdate = true;
    return most;
  }

  // The faces beside one.
  beside(face) {
    const {firstSide, across, curvature} = this.data, from = firstSide[face];
    const to = face + 1 < firstSide.length ? firstSide[face + 1] : across.length;
    return [...across.subarray(from, to)].filter(other => other < curvature.length);
  }

  // Marks a face, and weakly those beside it; -1: none.
  touch(face) {
    if (face === this.marked) return;
    this.marked = face;
    const {index, face: faces} = this.data, all = this.firstOfFace.has(face) ? [face, ...this.beside(face)] : [];
    let at = 0;
    const own = this.touched.geometry, list = own.index.array;
    own.clearGroups();
    all.forEach((other, i) => {
      const begin = at;
      for (let t = this.firstOfFace.get(other) ?? index.length; t < index.length && faces[index[t]] === other && at < list.length; t++) list[at++] = index[t];
      own.addGroup(begin, at - begin, i === 0 ? 0 : 1);
    });
    own.index.needsUpdate = true;
    own.setDrawRange(0, at);
    this.touchedBox.makeEmpty();
    for (let i = 0; i < at; i++) this.touchedBox.expandByPoint(new Vector3().fromArray(this.data.position, 3 * list[i]));
  }

  // Where a ray meets the surface: {point, face: {a, b, c}, distance} each.
  hits(ray) {
    this.tree ??= new MeshBVH(this.surface.geometry, {indirect: true});
    return this.tree.raycast(ray, DoubleSide);
  }

  // The surface's normal at such a place.
  normalAt({point, face: {a, b, c}}) {
    const {position, normal} = this.surface.geometry.attributes, corner = i => new Vector3().fromBufferAttribute(position, i);
    const weights = Triangle.getBarycoord(point, corner(a), corner(b), corner(c), new Vector3()) ?? new Vector3(1, 0, 0);
    return Triangle.getInterpolatedAttribute(normal, a, b, c, weights, new Vector3()).normalize();
  }

  dispose() {
    for (const mesh of this.all) mesh.geometry.dispose();
  }
}

export class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.ask = beforeNextPicture(() => this.draw());
    this.renderer = new WebGLRenderer({canvas, alpha: true, preserveDrawingBuffer: true});
    this.renderer.autoClear = false;
    this.renderer.debug.checkShaderErrors = false;  // it waits for each of them
    this.materials = makeMaterials();
    // Objects are drawn anew only where the camera or they have changed: the hand moves over large ones as well.
    [this.objects, this.scene, this.backdrop] = [new Scene(), new Scene(), new Backdrop()];
    this.fine = devicePixelRatio < 2 ? 2 : 1;  // scaled down, edges are smooth
    this.light = new DirectionalLight(0xffffff, 2.2);
    this.objects.add(new AmbientLight(0xffffff, 1.1), this.light);
    this.shown = [];
    this.hidden = new Set();
    this.view = 'both';
    this.by = 'clay';
    const ball = () => new Mesh(new SphereGeometry(1, 20, 14), new MeshBasicMaterial());
    [this.hip, this.scp] = [ball(), ball()];
    this.arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1);
    this.scene.add(this.hip, this.scp, this.arrow);
    this.hip.visible = this.scp.visible = this.arrow.visible = false;
    this.raycaster = new Raycaster();
    this.cuts = [];
    this.cut = new Plane(new Vector3(0, 0, -1), Infinity);
    canvas.setAttribute('aria-label', `The objects, and the hand on them. ${keysHint}`);
    this.prepare();
    onTheme(() => this.recolor());
    new ResizeObserver(() => this.askAll()).observe(canvas);
  }

  // Has the first picture's programs made, by drawing a triangle that is a point: in software that takes longer than to
  // read a mesh.
  prepare() {
    const point = new Mesh(new BufferGeometry(), this.materials.surface);
    for (const name of ['position', 'normal', 'color']) point.geometry.setAttribute(name, new BufferAttribute(new Float32Array(9), 3));
    point.frustumCulled = false;
    this.objects.add(point);
    this.renderer.setRenderTarget(this.backdrop.target);
    this.renderer.render(this.objects, new PerspectiveCamera());
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.backdrop.scene, this.backdrop.camera);
    this.objects.remove(point);
    point.geometry.dispose();
  }

  // All that is shown lies in this box.
  frame(box) {
    this.orbit = new Orbit(box, () => this.askAll());
    this.size = 2 * this.orbit.radius;
    this.hip.scale.setScalar(0.011 * this.size);
    this.scp.scale.setScalar(0.008 * this.size);
  }

  add(geometry) {
    const shown = new Shown(geometry, this.materials), old = this.shown[geometry.object];
    if (old) this.remove(old);
    this.shown[geometry.object] = shown;
    this.placed = null;  // its face is to be marked anew
    this.objects.add(...shown.still);
    this.scene.add(shown.touched);
    this.recolor();
    this.show(this.view);
  }

  // 'both': surface and edges; 'surface', 'polygons', 'edges'.
  show(view) {
    this.view = view;
    for (const [object, shown] of this.shown.entries()) {
      const isHere = shown && !this.hidden.has(object);
      if (!shown) continue;
      shown.surface.visible = isHere && (view === 'both' || view === 'surface');
      shown.polygons.visible = isHere && view === 'polygons';
      shown.edges.visible = isHere && view !== 'surface';
      shown.touched.visible = isHere;
    }
    this.askAll();
  }

  // Forgets the objects from this number on.
  keep(count) {
    this.shown.splice(count).filter(Boolean).forEach(shown => this.remove(shown));
    this.askAll();
  }

  remove(shown) {
    this.objects.remove(...shown.still);
    this.scene.remove(shown.touched);
    shown.dispose();
  }

  // Hides an object, or shows it again.
  hide(object, hidden) {
    if (hidden) this.hidden.add(object);
    else this.hidden.delete(object);
    this.show(this.view);
  }

  // 'clay', 'kind', 'height', whose largest one it gives, m, or 'curvature' against a depth, m.
  paint(by, depth = this.depth) {
    [this.by, this.depth] = [by, depth];
    const most = this.shown.filter(Boolean).map(shown => shown.paint(by, depth));
    this.askAll();
    return by === 'height' ? Math.max(...most) : null;
  }

  recolor() {
    const {polygons, edges, touched} = this.materials;
    polygons.color.setStyle(color('clay'));
    edges.color.setStyle(color('ink'));
    for (const material of touched) material.color.setStyle(color('accent'));
    this.hip.material.color.setStyle(color('accent'));
    this.paint(this.by);
  }

  // Hides what is beyond a share of the way along an axis; 1: nothing.
  cutAt(axis, share) {
    if (!this.orbit) return;
    const {min, max} = this.box;
    const at = min.getComponent(axis) + share * (max.getComponent(axis) - min.getComponent(axis));
    this.cut.normal.set(0, 0, 0).setComponent(axis, -1);
    this.cut.constant = at;
    this.cuts = share < 1 ? [this.cut] : [];
    this.askAll();
  }

  // A tick: where the hand is, and the force of the method that it feels.
  place(tick, method, name) {
    const felt = tick.felt[method], touching = felt.contact > 0;
    const state = [...[...tick.hip, ...felt.scp].map(x => Math.round(1e4 * x / this.size)), ...[...felt.force].map(f => Math.round(1e3 * f)),
      felt.contact, felt.object, felt.face, name].join();
    if (state === this.placed) return;  // no pixel differs
    this.placed = state;
    this.hip.visible = true;
    this.hip.position.fromArray(tick.hip);
    this.scp.visible = touching;
    this.scp.position.fromArray(felt.scp);
    const force = new Vector3().fromArray(felt.force), size = force.length();
    this.arrow.visible = touching && size > 0;
    if (this.arrow.visible) {
      this.arrow.position.copy(this.scp.position);
      this.arrow.setDirection(force.clone().divideScalar(size));
      const length = 0.12 * this.size * Math.min(3, size);
      this.arrow.setLength(length, Math.min(0.3 * length, 0.03 * this.size), 0.02 * this.size);
    }
    for (const mark of [this.scp.material.color, this.arrow.line.material.color, this.arrow.cone.material.color]) mark.setStyle(color(name));
    for (const [object, shown] of this.shown.entries()) shown?.touch(touching && felt.object === object ? felt.face : -1);
    this.ask();
  }

  askAll() {
    this.isOld = true;
    this.ask();
  }

  draw() {
    const {clientWidth, clientHeight} = this.canvas;
    if (!clientWidth || !this.orbit) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.floor(clientWidth * ratio) || this.canvas.height !== Math.floor(clientHeight * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(clientWidth, clientHeight, false);
      this.isOld = true;  // it is empty now
    }
    const {camera} = this.orbit;
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    const all = new Box2(new Vector2(), new Vector2(clientWidth, clientHeight)), covered = this.coveredByHand().intersect(all);
    const changed = this.isOld ? all : covered.clone().union(this.covered);
    this.covered = covered;
    if (this.isOld) this.drawObjects(camera);
    else this.wasOld = false;
    if (changed.isEmpty()) return;
    const {min, max} = changed;
    this.renderer.setScissor(min.x, min.y, max.x - min.x, max.y - min.y);
    this.renderer.setScissorTest(true);
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
    this.renderer.render(this.backdrop.scene, this.backdrop.camera);
    this.renderer.render(this.scene, camera);
    this.renderer.setScissorTest(false);
  }

  // The part of the canvas, in its pixels from below, that the hand and what it touches are in: all else stays as it is.
  coveredByHand() {
    const {camera} = this.orbit, {clientWidth, clientHeight} = this.canvas, place = new Box3(), part = new Box2();
    for (const ball of [this.hip, this.scp]) if (ball.visible) place.union(new Box3().setFromObject(ball));
    if (this.arrow.visible) place.union(new Box3().setFromObject(this.arrow));
    for (const shown of this.shown.filter(Boolean)) if (shown.touched.visible) place.union(shown.touchedBox);
    if (place.isEmpty()) return part;
    for (let i = 0; i < 8; i++) {
      const corner = new Vector3(...[0, 1, 2].map(k => (i >> k & 1 ? place.max : place.min).getComponent(k)));
      if (corner.clone().applyMatrix4(camera.matrixWorldInverse).z > -camera.near) return part.set(new Vector2(), new Vector2(clientWidth, clientHeight));
      const {x, y} = corner.project(camera);
      part.expandByPoint(new Vector2(0.5 * (1 + x) * clientWidth, 0.5 * (1 + y) * clientHeight));
    }
    part.expandByScalar(2);
    return part.set(part.min.floor(), part.max.ceil());
  }

  // Without a graphics card a picture takes long: then edges are less smooth.
  drawObjects(camera) {
    const now = performance.now();
    if (this.wasOld && now - this.drawnAt > 60 && now - this.drawnAt < 3000) this.fine = 1;
    [this.drawnAt, this.wasOld, this.isOld] = [now, true, false];
    this.light.position.copy(camera.position).addScaledVector(this.orbit.axis(1), 0.6 * this.size).addScaledVector(this.orbit.axis(0), -0.4 * this.size).sub(this.orbit.target);
    this.backdrop.target.setSize(this.canvas.width * this.fine, this.canvas.height * this.fine);
    this.renderer.setRenderTarget(this.backdrop.target);
    this.renderer.clear();
    this.renderer.clippingPlanes = this.cuts;
    this.renderer.render(this.objects, camera);
    this.renderer.clippingPlanes = [];
  }

  // The ray through a place of the canvas: {origin, direction}.
  ray(x, y) {
    const {clientWidth, clientHeight} = this.canvas;
    this.orbit.camera.updateMatrixWorld();
    this.raycaster.setFromCamera(new Vector2(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight), this.orbit.camera);
    return this.raycaster.ray;
  }

  // The foremost place of the surfaces there: {point, normal}; null: there is none.
  pick(x, y) {
    const ray = this.ray(x, y);
    let found = null;
    for (const [object, shown] of this.shown.entries()) {
      if (!shown || this.hidden.has(object)) continue;
      for (const hit of shown.hits(ray)) {
        if (hit.distance >= (found?.distance ?? Infinity) || this.cuts.some(plane => plane.distanceToPoint(hit.point) < 0)) continue;
        found = {shown, ...hit};
      }
    }
    return found && {point: found.point, normal: found.shown.normalAt(found)};
  }

  get box() { return this.orbit.box; }
}
