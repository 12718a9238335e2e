// Turning, moving and zooming a camera that several views share.
import {PerspectiveCamera, Quaternion, Vector3} from 'three';

export const keysHint = 'Arrow keys turn, with shift they move, plus and minus zoom, 0 resets.';

export class Orbit {
  // box: {min, max}. The widest side faces the camera, the longest lies across.
  constructor(box, changed) {
    this.changed = changed;
    this.box = box;
    this.centre = box.getCenter(new Vector3());
    const size = box.getSize(new Vector3()), axes = [0, 1, 2].sort((a, b) => size.getComponent(a) - size.getComponent(b));
    this.radius = size.length() / 2;
    this.camera = new PerspectiveCamera(30, 1, this.radius / 100, this.radius * 30);
    const [depth, height, width] = axes.map(axis => size.getComponent(axis));
    this.distance = 1.2 * Math.max(height, width * 3 / 4) / 2 / Math.tan(Math.PI / 12) + depth / 2;
    this.toward = new Vector3().setComponent(axes[0], 1);
    this.up = new Vector3().setComponent(axes[1], 1);
    this.reset();
  }

  reset() {
    this.target = this.centre.clone();
    this.offset = this.toward.clone().multiplyScalar(this.distance);
    this.camera.up.copy(this.up);
    this.turn(-40, 60);
  }

  axis(which) { return new Vector3().setFromMatrixColumn(this.camera.matrixWorld, which); }

  // By pixels of a drag.
  turn(dx, dy) {
    this.place();
    const speed = 0.008;
    const q = new Quaternion().setFromAxisAngle(this.axis(1), -dx * speed)
                  .multiply(new Quaternion().setFromAxisAngle(this.axis(0), -dy * speed));
    this.offset.applyQuaternion(q);
    this.camera.up.applyQuaternion(q);
    this.update();
  }

  move(dx, dy, height) {
    const scale = 2 * this.offset.length() * Math.tan(this.camera.fov * Math.PI / 360) / height;
    this.target.addScaledVector(this.axis(0), -dx * scale).addScaledVector(this.axis(1), dy * scale);
    this.update();
  }

  zoom(factor) {
    this.offset.clampLength(this.radius * 0.1, this.radius * 12).multiplyScalar(factor);
    this.update();
  }

  place() {
    this.camera.position.copy(this.target).add(this.offset);
    this.camera.lookAt(this.target);
    this.camera.updateMatrixWorld();
  }

  update() {
    this.place();
    this.changed();
  }

  // Mouse, fingers and keys over an element. The wheel belongs to the page until the view is clicked. `isOurs` says which
  // presses and turns of the wheel are the camera's.
  listen(element, isOurs = () => true) {
    const pointers = new Map();
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a.x - b.x, a.y - b.y);
    };
    element.addEventListener('pointerdown', event => {
      if (!isOurs(event)) return;
      element.focus({preventScroll: true});
      element.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    });
    element.addEventListener('pointermove', event => {
      const last = pointers.get(event.pointerId);
      if (!last) return;
      const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
      const before = pointers.size === 2 ? spread() : 0;
      pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
      if (pointers.size === 2) this.zoom(before / Math.max(1, spread()));
      else if (event.shiftKey || event.buttons & 2) this.move(dx, dy, element.clientHeight);
      else this.turn(dx, dy);
    });
    for (const end of ['pointerup', 'pointercancel']) {
      element.addEventListener(end, event => pointers.delete(event.pointerId));
    }
    element.addEventListener('contextmenu', event => event.preventDefault());
    element.addEventListener('wheel', event => {
      if (document.activeElement !== element || !isOurs(event)) return;
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.001));
    }, {passive: false});
    element.addEventListener('keydown', event => this.press(event, element));
  }

  press(event, element) {
    const arrow = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    const zoom = {'+': 0.85, '=': 0.85, '-': 1 / 0.85}[event.key];
    if (arrow && event.shiftKey) this.move(20 * arrow[0], 20 * arrow[1], element.clientHeight);
    else if (arrow) this.turn(15 * arrow[0], 15 * arrow[1]);
    else if (zoom) this.zoom(zoom);
    else if (event.key === '0') this.reset();
    else return;
    event.preventDefault();
  }
}
