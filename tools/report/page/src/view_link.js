// The socket of gliss view: what comes is handed on as objects and arrays, the hand's target goes out 60 times a second,
// and a lost server is looked for again.

const marks = {frame: 0x31464c47, geometry: 0x47464c47};
const rowNumbers = 9 + 3 * 11;
export const sendEvery = 16, tryAgainAfter = 500;  // ms

// As tools/view/beside.h packs it: {number, time, count, rows}; `at(i)` gives a tick.
export function readFrame(buffer) {
  const head = new DataView(buffer);
  const count = head.getUint32(4, true), rows = new Float32Array(buffer, 24, count * rowNumbers);
  return {
    number: head.getFloat64(8, true),
    time: head.getFloat64(16, true),
    count,
    at(i) {
      const row = rows.subarray(i * rowNumbers, (i + 1) * rowNumbers);
      const felt = [0, 1, 2].map(m => {
        const own = row.subarray(9 + 11 * m, 20 + 11 * m);
        return {force: own.subarray(0, 3), scp: own.subarray(3, 6), depth: own[6], contact: own[7], object: own[8], face: own[9], work: own[10]};
      });
      return {since: row[0], hip: row.subarray(1, 4), sent: row.subarray(4, 7), guard: row[7], reason: row[8], felt};
    },
  };
}

// As tools/view/view_geometry.h packs it.
export function readGeometry(buffer) {
  const [, object, points, triangles, edges, polygons, faces, sides] = new Uint32Array(buffer, 0, 8);
  let at = 32;
  const take = (Kind, length) => {
    const array = new Kind(buffer, at, length);
    at += array.byteLength;
    return array;
  };
  const position = take(Float32Array, 3 * points), packed = take(Int8Array, 4 * points);
  return {object, position, packed, height: take(Float32Array, points), face: take(Uint32Array, points),
    index: take(Uint32Array, 3 * triangles), edges: take(Float32Array, 6 * edges), polygons: take(Float32Array, 9 * polygons),
    curvature: take(Float32Array, faces), firstSide: take(Uint32Array, faces), across: take(Uint32Array, sides)};
}

export class Link {
  // on: {text, frame, geometry, open, lost}; target(): where the hand is to be, [x, y, z] in m, or null.
  constructor(on, target) {
    [this.on, this.target] = [on, target];
    this.token = location.hash.slice(1);
    this.steers = false;
    this.connect();
    setInterval(() => this.point(), sendEvery);
  }

  connect() {
    this.socket = new WebSocket(`ws://${location.host}/touch`, `gliss.${this.token}`);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => this.on.open();
    this.socket.onmessage = ({data}) => this.take(data);
    this.socket.onclose = () => {
      this.steers = false;
      this.on.lost();
      setTimeout(() => this.connect(), tryAgainAfter);
    };
  }

  take(data) {
    if (typeof data === 'string') {
      const message = JSON.parse(data);
      if (message.steers !== undefined) this.steers = message.steers;
      return this.on.text(message);
    }
    const mark = new DataView(data).getUint32(0, true);
    if (mark === marks.frame) this.on.frame(readFrame(data));
    if (mark === marks.geometry) this.on.geometry(readGeometry(data));
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN && this.steers) this.socket.send(JSON.stringify(message));
  }

  // Also where nothing moves: a silent page is one that has gone.
  point() {
    const target = this.steers && this.socket.bufferedAmount < 4096 && this.target();
    if (target && target.every(Number.isFinite)) this.send({hand: target});
  }
}
