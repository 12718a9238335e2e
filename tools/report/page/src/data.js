// What gliss put into the page: arrays are base64 in JSON. Positions and forces of sweeps are 16-bit steps of a scale from
// an offset, finer than a screen shows: {i16, offset, scale}, the latter for each of the interleaved columns.

const kinds = {f32: Float32Array, u32: Uint32Array, u16: Uint16Array, i16: Int16Array};

const notFinite = -32768;

function restored({scale, offset}, steps) {
  return Float32Array.from(steps, (step, i) => step === notFinite ? NaN : offset[i % offset.length] + scale[i % scale.length] * step);
}

function unpack(key, value) {
  const kind = value && typeof value === 'object' && Object.keys(value)[0];
  if (!(kind in kinds) || typeof value[kind] !== 'string') return value;
  const text = atob(value[kind]);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const array = new kinds[kind](bytes.buffer);
  return value.scale ? restored(value, array) : array;
}

export function readResults() {
  const element = document.getElementById('results');
  const data = JSON.parse(element.textContent, unpack);
  element.remove();  // its text is not needed again
  return data;
}
