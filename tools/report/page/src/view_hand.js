// The hand that the pointer pulls: it hovers where one points, and is pressed in where one holds.
import {Vector3} from 'three';

const sinking = 0.15;  // of the size of all, in a second

export class Hand {
  // rest: where it is before anybody points. press: m beneath the surface, that it is drawn to.
  constructor(stage, rest, press) {
    this.stage = stage;
    this.at = new Vector3(...rest);  // where it is, as the loop says
    this.wish = this.at.clone();
    [this.press, this.least, this.most] = [press, press / 30, press * 8];
    this.pointer = null;  // a place of the canvas
    this.held = false;
    this.isSafe = false;  // the guard let no force out: the hand comes out by itself, and goes in again
  }

  point(x, y) {
    const {clientWidth, clientHeight} = this.stage.canvas;
    this.pointer = {x: Math.max(0, Math.min(clientWidth, x)), y: Math.max(0, Math.min(clientHeight, y))};
  }

  move(dx, dy) {
    const {clientWidth, clientHeight} = this.stage.canvas, from = this.pointer ?? {x: clientWidth / 2, y: clientHeight / 2};
    this.point(from.x + dx, from.y + dy);
  }

  isOver(x, y) { return this.stage.pick(x, y) !== null; }

  deeper(factor) { this.press = Math.max(this.least, Math.min(this.most, this.press * factor)); }

  // Where the pointer's ray meets the objects; beside them it is as far from the eye as it last was.
  aim() {
    const {x, y} = this.pointer, camera = this.stage.orbit.camera;
    const state = [x, y, ...camera.matrixWorld.elements, this.stage.shown.length].join();
    if (state !== this.aimed) {
      this.aimed = state;
      const hit = this.stage.pick(x, y), {direction} = this.stage.ray(x, y);
      this.toEye = direction.clone().negate();
      const away = (this.hit ?? {point: this.stage.orbit.target}).point.distanceTo(camera.position);
      this.onRay = camera.position.clone().addScaledVector(direction, away);
      this.isOn = hit !== null;
      if (hit) this.hit = hit;
    }
  }

  // Far from the ray it goes round by the eye's side of the objects, not through them.
  target() {
    if (!this.pointer) return this.wish.toArray();
    this.aim();
    const place = this.isOn ? this.hit.point : this.onRay;
    const apart = this.at.clone().sub(place), lateral = apart.addScaledVector(this.toEye, -apart.dot(this.toEye)).length();
    const {size} = this.stage, hover = 0.04 * size;
    const presses = this.held && !this.isSafe && lateral < (this.pressing ? 0.3 : 0.08) * size;
    this.pressing = presses;
    const above = this.sink(presses ? -this.press : hover + lateral, size);
    this.wish.copy(place);
    if (above > 0) this.wish.addScaledVector(this.toEye, above);
    else if (this.isOn) this.wish.addScaledVector(this.hit.normal, above);
    return this.wish.toArray();
  }

  // How far above the surface the hand is wanted on its way to `to`, m: it does not fall in, since the force of a hand
  // that comes in quickly changes quickly by any method. Up it goes at once, but no less gently where the guard let go.
  sink(to, size) {
    const now = performance.now(), way = sinking * size * Math.min(0.1, (now - (this.sankAt ?? now)) / 1e3);
    this.sankAt = now;
    const from = this.above ?? to;
    this.above = Math.max(to, from - way);
    if (this.isSafe) this.above = Math.min(this.above, from + way);
    return this.above;
  }
}
