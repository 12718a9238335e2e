// A gamepad: its left stick moves the hand, its right one turns the view, a trigger or A presses; it rumbles at steps.

const dead = 0.15;          // of a stick's way
const speed = 0.5, turning = 250;  // of the canvas and pixels, in a second
const loudest = 0.2;        // N, of a step that rumbles as much as it can

const stick = (x, y) => Math.hypot(x, y) < dead ? [0, 0] : [x, y];

export class Pad {
  // on: {move(dx, dy) as shares of the canvas, turn(dx, dy) in pixels, hold(held), deeper(factor)}
  constructor(on) {
    [this.on, this.held, this.largest] = [on, false, 0];
    addEventListener('gamepadconnected', () => this.start());
    if (this.find()) this.start();
  }

  find() { return [...navigator.getGamepads?.() ?? []].find(Boolean); }

  start() {
    if (this.last !== undefined) return;
    this.last = performance.now();
    const turn = now => {
      if (!this.read((now - this.last) / 1e3)) return void (this.last = undefined);
      this.last = now;
      requestAnimationFrame(turn);
    };
    requestAnimationFrame(turn);
  }

  // False where it has gone.
  read(seconds) {
    const pad = this.find();
    if (!pad) return false;
    const [lx, ly] = stick(pad.axes[0] ?? 0, pad.axes[1] ?? 0), [rx, ry] = stick(pad.axes[2] ?? 0, pad.axes[3] ?? 0);
    if (lx || ly) this.on.move(lx * speed * seconds, ly * speed * seconds);
    if (rx || ry) this.on.turn(rx * turning * seconds, ry * turning * seconds);
    const value = i => pad.buttons[i]?.value ?? 0;
    const held = value(0) > 0.5 || value(7) > 0.1;
    if (held !== this.held) this.on.hold(this.held = held);
    const deeper = (value(5) > 0.5) - (value(4) > 0.5);
    if (deeper) this.on.deeper(2 ** (deeper * seconds));
    this.rumble(pad);
    return true;
  }

  // The largest step of the method that the hand feels, N, since the last call of read().
  feel(step) { this.largest = Math.max(this.largest, step); }

  rumble(pad) {
    const share = Math.min(1, this.largest / loudest);
    this.largest = 0;
    if (share < 0.02) return;
    pad.vibrationActuator?.playEffect?.('dual-rumble', {duration: 40, strongMagnitude: share, weakMagnitude: share})?.catch(() => {});
  }
}
