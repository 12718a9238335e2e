// The numbers of a tile as the few bits that its words have of them (layout.h). A code is a whole
// number; beside the function that makes one of a number stands the one that reads it. Codes are
// made on the host only, in double: words have 32 bits.

FN real whole_above(real x) {
  const real floor = whole_part(x);
  return pick(floor < x, floor + K(1), floor);
}
// Within [0, most]; NaN counts as `most`.
FN real limit_code(real x, scalar most) {
  return pick(x < most, larger(x, splat(K(0))), splat(most));
}

// A word of two numbers of 16 bits.
FN real halves_code(real low, real high) { return fma(high, splat(K(65536)), low); }
FN real low_half(uints word) { return reals_of(word & 65535u); }
FN real high_half(uints word) { return reals_of(word >> 16); }

// A coordinate of a centre: 16 bits, in steps from the low corner of the patch's box.
FN real centre_code(real at, real low, real step) {
  const real x = limit_code((at - low) / step + K(0.5f), K(65535));
  return pick(step > splat(K(0)), whole_part(x), splat(K(0)));
}
FN real centre_of_code(real code, real low, real step) { return fma(code, step, low); }

// A radius or half a height: 16 bits, in units, rounded up.
FN real length_code(real length, real unit) {
  return whole_above(limit_code(length / unit, K(65535)));
}

// x or y of a unit axis whose z is not negative: 12 bits.
FN real axis_code(real x) {
  const real far = whole_part(K(2047) * fabs(x));
  return limit_code(pick(x < K(0), K(2048) - far, K(2048) + far), K(4095));
}
FN real3 axis_of_codes(real code_x, real code_y) {
  const real x = (code_x - K(2048)) * K(0x1p-11f), y = (code_y - K(2048)) * K(0x1p-11f);
  return make3(x, y, sqrt(larger(K(1) - fma(x, x, y * y), splat(K(0)))));
}

// The tangent of an angle: 7 bits, rounded up.
FN real lean_code(real tangent) {
  return whole_above(limit_code(sqrt(K(1 << TILE_LEAN_SHIFT) * tangent), K(TILE_ANY_LEAN)));
}
FN real tangent_of_code(real code) { return code * code * (K(1) / K(1 << TILE_LEAN_SHIFT)); }

// The largest whole b, 255 at most, with b^3 <= x.
FN real cube_root(real x) {
  real b = splat(K(0));
  for (int step = 128; step > 0; step /= 2) {
    const real t = b + K(step);
    b = pick(t * t * t <= x, t, b);
  }
  return b;
}

// A curvature over the patch's largest, `most`: 8 bits, rounded down or up.
FN real curvature_code(real relative, int up) {
  const real x = K(2048383) * fabs(relative), b = cube_root(x);  // 127^3
  const real away = pick(b * b * b < x, b + K(1), b);
  const mask below = relative < K(0);
  const real r = K(128) + pick(below, up ? -b : -away, up ? away : b);
  return limit_code(r, K(255));
}
FN real curvature_of_code(real code, real most) {
  const real c = (code - K(128)) * splat(K(1) / K(127));
  return c * c * c * most;
}

// A second fundamental form, a whole word: 9 bits for each of three numbers, and 5 for the power of
// two that is above all.
FN real second_code(real3 s) {
  const real zero = splat(K(0));
  const mask is_finite = zero_if_finite(s) == zero;
  s = pick3(is_finite, s, zero3());
  const real most = larger(larger(fabs(s.x), fabs(s.y)), fabs(s.z));
  real power = splat(K(0x1p-16f)), count = zero;
  for (int step = 16; step > 0; step /= 2) {
    const mask more = most >= power * K(1 << (step - 1));
    const scalar by = K(1 << step);
    power = pick(more, power * by, power);
    count = pick(more, count + K(step), count);
  }
  const real scale = K(256) / power;
  const real x = whole_part(limit_code(fma(s.x, scale, splat(K(256.5f))), K(511))),
             y = whole_part(limit_code(fma(s.y, scale, splat(K(256.5f))), K(511))),
             z = whole_part(limit_code(fma(s.z, scale, splat(K(256.5f))), K(511)));
  return fma(count, splat(K(0x1p27f)), fma(z, splat(K(0x1p18f)), fma(y, splat(K(512)), x)));
}
#if GLISS_LANES == 1
FN sym2 second_of_code(uint word) {
  const real scale = (real)(int)(1u << (word >> 27)) * K(0x1p-24f);
  const sym2 s = {scale * ((real)(int)(word & 511u) - K(256)),
                  scale * ((real)(int)(word >> 9 & 511u) - K(256)),
                  scale * ((real)(int)(word >> 18 & 511u) - K(256))};
  return s;
}
#endif
