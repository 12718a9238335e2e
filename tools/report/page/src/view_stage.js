// The scene of gliss view: surfaces, polygons, the hand and what it touches; and the place under the pointer.
import {AmbientLight, ArrowHelper, BufferAttribute, BufferGeometry, Camera, Color, DepthTexture, DirectionalLight, DoubleSide, GLSL3,
  HalfFloatType, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, Plane, PlaneGeometry, Raycaster, Scene,
  ShaderMaterial, SphereGeometry, Vector2, Vector3, WebGLRenderer, WebGLRenderTarget} from 'three';
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

// An object's meshes, and the arrays that are picked in.
class Shown {
  constructor(geometry) {
    this.data = geometry;
    const surface = new BufferGeometry();
    surface.setAttribute('position', new BufferAttribute(geometry.position, 3));
    const normals = new Int8Array(geometry.position.length);
    for (let i = 0; i < normals.length; i++) normals[i] = geometry.packed[4 * Math.floor(i / 3) + i % 3];
    this.normals = normals;
    surface.setAttribute('normal', new BufferAttribute(normals, 3, true));
    this.colors = new BufferAttribute(new Uint8Array(geometry.position.length), 3, true);
    surface.setAttribute('color', this.colors);
    surface.setIndex(new BufferAttribute(geometry.index, 1));
    this.surface = new Mesh(surface, new MeshLambertMaterial({vertexColors: true, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
    const touched = new BufferGeometry();
    for (const name of ['position', 'normal']) touched.setAttribute(name, surface.getAttribute(name));
    touched.setIndex(new BufferAttribute(new Uint32Array(mostMarked), 1));
    touched.setDrawRange(0, 0);
    this.touched = new Mesh(touched, [0.5, 0.2].map(opacity => new MeshBasicMaterial({side: DoubleSide, transparent: true, opacity, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -4})));
    const polygons = new BufferGeometry();
    polygons.setAttribute('position', new BufferAttribute(geometry.polygons, 3));
    polygons.computeVertexNormals();
    this.polygons = new Mesh(polygons, new MeshLambertMaterial({side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1}));
    const edges = new BufferGeometry();
    edges.setAttribute('position', new BufferAttribute(geometry.edges, 3));
    this.edges = new LineSegments(edges, new LineBasicMaterial({transparent: true, opacity: 0.55}));
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
  }

  dispose() {
    for (const mesh of this.all) (mesh.geometry.dispose(), [mesh.material].flat().forEach(material => material.dispose()));
  }
}

export class Stage {
  constructor(canvas, box) {
    this.canvas = canvas;
    this.ask = beforeNextPicture(() => this.draw());
    this.renderer = new WebGLRenderer({canvas, alpha: true});
    this.renderer.autoClear = false;
    // Objects are drawn anew only where the camera or they have changed: the hand moves over large ones as well.
    [this.objects, this.scene, this.backdrop] = [new Scene(), new Scene(), new Backdrop()];
    this.fine = devicePixelRatio < 2 ? 2 : 1;  // scaled down, edges are smooth
    this.orbit = new Orbit(box, () => this.askAll());
    this.size = 2 * this.orbit.radius;
    this.light = new DirectionalLight(0xffffff, 2.2);
    this.objects.add(new AmbientLight(0xffffff, 1.1), this.light);
    this.shown = [];
    this.hidden = new Set();
    this.view = 'both';
    this.by = 'clay';
    const ball = radius => new SphereGeometry(radius * this.size, 20, 14);
    this.hip = new Mesh(ball(0.011), new MeshBasicMaterial());
    this.scp = new Mesh(ball(0.008), new MeshBasicMaterial());
    this.arrow = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 1);
    this.hip.visible = this.scp.visible = this.arrow.visible = false;
    this.scene.add(this.hip, this.scp, this.arrow);
    this.raycaster = new Raycaster();
    this.cuts = [];
    this.cut = new Plane(new Vector3(0, 0, -1), Infinity);
    canvas.setAttribute('aria-label', `The objects, and the hand on them. ${keysHint}`);
    onTheme(() => this.recolor());
    new ResizeObserver(() => this.askAll()).observe(canvas);
  }

  add(geometry) {
    const shown = new Shown(geometry), old = this.shown[geometry.object];
    if (old) this.remove(old);
    this.shown[geometry.object] = shown;
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
    for (const shown of this.shown.filter(Boolean)) {
      shown.polygons.material.color.setStyle(color('clay'));
      shown.edges.material.color.setStyle(color('ink'));
      for (const material of shown.touched.material) material.color.setStyle(color('accent'));
    }
    this.hip.material.color.setStyle(color('accent'));
    this.paint(this.by);
  }

  // Hides what is beyond a share of the way along an axis; 1: nothing.
  cutAt(axis, share) {
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
    if (!clientWidth) return;
    const ratio = Math.min(2, devicePixelRatio);
    if (this.canvas.width !== Math.floor(clientWidth * ratio) || this.canvas.height !== Math.floor(clientHeight * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(clientWidth, clientHeight, false);
    }
    const {camera} = this.orbit;
    camera.aspect = clientWidth / clientHeight;
    camera.updateProjectionMatrix();
    if (this.isOld) this.drawObjects(camera);
    else this.wasOld = false;
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
    this.renderer.render(this.backdrop.scene, this.backdrop.camera);
    this.renderer.render(this.scene, camera);
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
    const {origin: o, direction: d} = this.ray(x, y);
    let best = Infinity, found = null;
    for (const [object, shown] of this.shown.entries()) {
      if (!shown || this.hidden.has(object)) continue;
      const p = shown.data.position, index = shown.data.index;
      for (let t = 0; t < index.length; t += 3) {
        const a = 3 * index[t], b = 3 * index[t + 1], c = 3 * index[t + 2];
        const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
        const vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
        const hx = d.y * vz - d.z * vy, hy = d.z * vx - d.x * vz, hz = d.x * vy - d.y * vx;
        const det = ux * hx + uy * hy + uz * hz;
        if (det === 0) continue;
        const sx = o.x - p[a], sy = o.y - p[a + 1], sz = o.z - p[a + 2];
        const u = (sx * hx + sy * hy + sz * hz) / det;
        if (u < 0 || u > 1) continue;
        const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
        const v = (d.x * qx + d.y * qy + d.z * qz) / det;
        if (v < 0 || u + v > 1) continue;
        const far = (vx * qx + vy * qy + vz * qz) / det;
        if (far <= 0 || far >= best) continue;
        const at = o.clone().addScaledVector(d, far);
        if (this.cuts.some(plane => plane.distanceToPoint(at) < 0)) continue;
        best = far;
        found = {shown, point: at, weights: [[a, 1 - u - v], [b, u], [c, v]]};
      }
    }
    if (!found) return null;
    const normal = new Vector3();
    for (const [at, weight] of found.weights) normal.addScaledVector(new Vector3().fromArray(found.shown.normals, at), weight);
    return {point: found.point, normal: normal.normalize()};
  }

  get box() { return this.orbit.box; }
}
