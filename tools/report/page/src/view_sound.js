// The steps of a method's force as clicks, as loud as they are large: silent until somebody asks.

const loudest = 0.2;  // N, of a step that clicks as loud as it can
const rate = 16000, ahead = 0.06, click = 0.004;  // Hz; s; s

export class Sound {
  constructor() { this.method = null; }

  // An index of methods, or null for silence. Browsers start sound only where a person has pressed something.
  choose(method) {
    this.method = method;
    if (method !== null && !this.context) this.context = new AudioContext();
    if (method === null) this.context?.suspend();
    else this.context.resume();
  }

  // The steps of a frame, [tick][method] in N, a period (s) apart.
  play(steps, period) {
    if (this.method === null || !steps.length) return;
    const samples = new Float32Array(Math.ceil((steps.length * period + click) * rate));
    let any = false;
    steps.forEach((own, i) => {
      const loud = Math.min(1, own[this.method] / loudest);
      if (loud < 0.01) return;
      any = true;
      const first = Math.floor(i * period * rate);
      for (let s = 0; s < click * rate; s++) samples[first + s] += loud * (Math.random() * 2 - 1) * Math.exp(-6 * s / (click * rate));
    });
    const now = this.context.currentTime;
    this.next = Math.max(this.next ?? 0, now + ahead);
    const at = this.next;
    this.next += steps.length * period;
    if (this.next > now + 4 * ahead) this.next = now + ahead;
    if (!any) return;
    const buffer = this.context.createBuffer(1, samples.length, rate);
    buffer.copyToChannel(samples, 0);
    const source = this.context.createBufferSource();
    source.buffer = buffer;
    source.connect(this.context.destination);
    source.start(at);
    this.played = (this.played ?? 0) + 1;
  }
}
