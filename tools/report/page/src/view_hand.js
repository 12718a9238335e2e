// The hand that the pointer pulls: it hovers where one points, and is pressed in where one holds.
import {Vector3} from 'three';

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
    this.wish.copy(place);
    if (!presses) this.wish.addScaledVector(this.toEye, hover + lateral);
    else if (this.isOn) this.wish.addScaledVector(this.hit.normal, -this.press);
    return this.wish.toArray();
  }
}
