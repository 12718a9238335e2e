// The net work of the loop just drawn: what each method's force has done on the hand from a place back to it.
import {el} from './dom.js';
import {number} from './format.js';
import {methodTitle} from './methods.js';
import {methods} from './view_plots.js';

export class WorkLoop {
  constructor() {
    this.told = el('output.loop', {role: 'status'});
    this.began = null;
  }

  // Begins at this tick, or ends at it and tells. False where a loop has ended.
  toggle(tick) {
    if (!tick) return false;
    const now = {hip: [...tick.hip], work: tick.felt.map(felt => felt.work)};
    if (!this.began) {
      this.began = now;
      this.told.textContent = 'Draw a loop, back to where it began';
      return true;
    }
    const gap = Math.hypot(...now.hip.map((x, i) => x - this.began.hip[i]));
    const works = now.work.map((w, m) => `${methodTitle(methods[m])} ${number(w - this.began.work[m])} mJ`);
    this.told.textContent = `Net work on the hand: ${works.join(', ')}; the ends are ${number(1e3 * gap)} mm apart`;
    this.began = null;
    return false;
  }

  // A loop that has begun is another's now.
  clear() {
    if (this.began) this.told.textContent = '';
    this.began = null;
  }
}
