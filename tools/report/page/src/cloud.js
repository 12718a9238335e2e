// Points lit as if the directions of their forces were normals, on a canvas; the camera is shared. They may have colours
// by a number of theirs, and marks over them.
import {BufferAttribute, BufferGeometry, GLSL3, Points, Scene, ShaderMaterial, Vector3, WebGLRenderer, Color} from 'three';
import {beforeNextPicture} from './dom.js';
import {color, onTheme} from './theme.js';

// Browsers allow few contexts: one draws all views, one after the other, each is copied to its canvas.
let renderer;
export function startClouds() {
  if (renderer) return true;
  try {
    renderer = new WebGLRenderer({alpha: true});
    renderer.setClearAlpha(0);
  } catch {
    renderer = null;
  }
  return renderer !== null;
}

// Colours from little to much, told apart by those who see few colours as well.
export const ramp = ['#4575b4', '#91bfdb', '#fee090', '#fc8d59', '#b2182b'];

const vertexShader = `
in vec3 force;
in float spacing, heat;
uniform float pixels;  // of a unit of length at distance 1
uniform bool direction;
out vec3 normal_;
out float depth;  // by how much the rim of a point lies behind its middle
out float heat_;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = max(2.0, spacing * pixels / -seen.z);
  vec4 behind = projectionMatrix * (seen - vec4(0.0, 0.0, spacing, 0.0));
  depth = 0.5 * (behind.z / behind.w - gl_Position.z / gl_Position.w);
  float size = length(force);
  vec3 unit = size > 0.0 ? force / size : vec3(0.0);
  normal_ = direction ? unit : normalMatrix * unit;
  heat_ = heat;
}`;

const fragmentShader = `
in vec3 normal_;
in float depth, heat_;
uniform bool direction, heated;
uniform vec3 clay, free, ramp[5];
out vec4 shade;
void main() {
  vec2 place = 2.0 * gl_PointCoord - 1.0;
  float rim = dot(place, place);
  if (rim > 1.0) discard;
  gl_FragDepth = gl_FragCoord.z + rim * depth;  // where points overlap, the nearer middle wins
  if (dot(normal_, normal_) < 0.25) { shade = vec4(free, 1.0); return; }
  vec3 n = normalize(normal_);
  if (direction) { shade = vec4(0.5 + 0.45 * n, 1.0); return; }
  vec3 light = normalize(vec3(-0.5, 0.7, 0.75));
  float lit = 0.5 + 0.5 * dot(n, light);
  if (heated) {
    float at = 4.0 * heat_;
    int below = min(int(at), 3);
    shade = vec4(mix(ramp[below], ramp[below + 1], at - float(below)) * (0.5 + 0.55 * lit), 1.0);
    return;
  }
  float gleam = pow(max(dot(n, normalize(light + vec3(0.0, 0.0, 1.0))), 0.0), 48.0);
  shade = vec4(clay * (0.16 + 0.92 * lit * lit) + 0.30 * gleam, 1.0);
}`;

const markVertexShader = `
in float size;
uniform float fine, nearer;
out float across;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  seen.z += nearer;  // the surface does not cover what lies on it
  gl_Position = projectionMatrix * seen;
  across = size * fine;
  gl_PointSize = across;
}`;

const markFragmentShader = `
in float across;
uniform vec3 core, ring;
out vec4 shade;
void main() {
  float away = length(gl_PointCoord - 0.5) * 2.0;
  if (away > 1.0) discard;
  shade = vec4(away > 0.66 ? ring : core, 1.0);
}`;

// How far samples lie apart: all patches have equally many, whatever their size.
export function spacings(positions, patches) {
  const spacing = new Float32Array(patches.length);
  for (let begin = 0, end; begin < patches.length; begin = end) {
    end = begin;
    const centre = new Vector3(), point = new Vector3();
    while (end < patches.length && patches[end] === patches[begin]) centre.add(point.fromArray(positions, 3 * end++));
    centre.divideScalar(end - begin);
    let reach = 0;
    for (let i = begin; i < end; i++) reach = Math.max(reach, point.fromArray(positions, 3 * i).distanceTo(centre));
    spacing.fill(2.8 * reach / Math.sqrt(end - begin), begin, end);
  }
  return spacing;
}

export class CloudView {
  // canvas; points: {positions, spacing, heat} as BufferAttributes, heat from 0 to 1 or absent; forces: Float32Array.
  constructor(canvas, points, forces, orbit) {
    this.canvas = canvas;
    this.ask = beforeNextPicture(() => this.draw());
    this.orbit = orbit;
    this.positions = points.positions.array;
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', points.positions);
    geometry.setAttribute('spacing', points.spacing);
    geometry.setAttribute('force', new BufferAttribute(forces, 3));
    if (points.heat) geometry.setAttribute('heat', points.heat);
    this.material = new ShaderMaterial({
      vertexShader,
      fragmentShader,
      glslVersion: GLSL3,
      uniforms: {pixels: {value: 1}, direction: {value: false}, heated: {value: Boolean(points.heat)}, clay: {value: new Color()},
        free: {value: new Color()}, ramp: {value: ramp.map(shade => new Color().setStyle(shade, ''))}},
    });
    this.scene = new Scene();
    this.scene.add(new Points(geometry, this.material));
    this.marked = null;
    onTheme(() => this.ask());
    new ResizeObserver(() => this.ask()).observe(canvas);
  }

  // Dots over the surface. positions: x y z ...; sizes in pixels.
  setMarks(positions, sizes) {
    if (!this.marks) {
      const material = new ShaderMaterial({
        vertexShader: markVertexShader,
        fragmentShader: markFragmentShader,
        glslVersion: GLSL3,
        uniforms: {fine: {value: 1}, nearer: {value: 0.03 * this.orbit.radius}, core: {value: new Color(0, 0, 0)}, ring: {value: new Color(1, 1, 1)}},
      });
      this.marks = new Points(undefined, material);
      this.marks.frustumCulled = false;
      this.scene.add(this.marks);
    }
    this.marks.geometry.dispose();
    this.marks.geometry = new BufferGeometry();
    this.marks.geometry.setAttribute('position', new BufferAttribute(positions, 3));
    this.marks.geometry.setAttribute('size', new BufferAttribute(sizes, 1));
    this.ask();
  }

  draw() {
    const {clientWidth, clientHeight} = this.canvas;
    if (!clientWidth || !renderer) return;
    const [width, height] = [clientWidth, clientHeight].map(size => Math.round(size * devicePixelRatio));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
    const fine = devicePixelRatio < 2 ? 2 : 1;  // scaled down, edges are smooth
    renderer.setSize(width * fine, height * fine, false);
    const {camera} = this.orbit, {uniforms} = this.material;
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    uniforms.pixels.value = height * fine / (2 * Math.tan(camera.fov * Math.PI / 360));
    // As they are: the shader's colours go to the screen without conversion.
    uniforms.clay.value.setStyle(color('clay'), '');
    uniforms.free.value.setStyle(color('free'), '');
    if (this.marks) this.marks.material.uniforms.fine.value = fine * devicePixelRatio;
    renderer.render(this.scene, camera);
    const context = this.canvas.getContext('2d');
    context.clearRect(0, 0, width, height);
    context.drawImage(renderer.domElement, 0, 0, width, height);
    if (this.marked !== null) this.mark(context);
  }

  onScreen(index, out = new Vector3(), positions = this.positions) {
    out.fromArray(positions, 3 * index).project(this.orbit.camera);
    out.x = (out.x + 1) / 2 * this.canvas.clientWidth;
    out.y = (1 - out.y) / 2 * this.canvas.clientHeight;
    return out;
  }

  mark(context) {
    const {x, y} = this.onScreen(this.marked);
    for (const [width, name] of [[4, 'paper'], [2, 'ink']]) {
      context.lineWidth = width * devicePixelRatio;
      context.strokeStyle = color(name);
      context.beginPath();
      context.arc(x * devicePixelRatio, y * devicePixelRatio, 7 * devicePixelRatio, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  // The foremost point at a place of the canvas, or null.
  pick(x, y) { return this.foremost(x, y, this.positions)[0]; }

  // {mark} or {point}: the mark there, if the surface does not hide it; {}: neither.
  pickAny(x, y) {
    const [point, far] = this.foremost(x, y, this.positions);
    const [mark, markFar] = this.marks ? this.foremost(x, y, this.marks.geometry.attributes.position.array) : [null, 0];
    if (mark !== null && markFar < far + 0.05 * this.orbit.radius) return {mark};
    return point === null ? {} : {point};
  }

  // Its index and how far it is.
  foremost(x, y, positions) {
    const reach = 7, at = new Vector3(), {camera, radius} = this.orbit;
    let best = null, least = Infinity;
    for (let i = 0; i < positions.length / 3; i++) {
      this.onScreen(i, at, positions);
      const away = Math.hypot(at.x - x, at.y - y);
      if (away > reach) continue;
      // Of points about as near to the eye, the one under the cursor.
      const far = at.fromArray(positions, 3 * i).distanceTo(camera.position) + 0.003 * radius * away;
      if (far < least) [best, least] = [i, far];
    }
    return [best, least];
  }
}
