// Vectors of three. A plain struct: OpenCL's float3 takes the room of four.

typedef struct {
  real x, y, z;
} real3;

FN real3 make3(real x, real y, real z) {
  real3 r = {x, y, z};
  return r;
}
FN real3 zero3() { return make3(splat(K(0)), splat(K(0)), splat(K(0))); }
FN real3 add3(real3 a, real3 b) { return make3(a.x + b.x, a.y + b.y, a.z + b.z); }
FN real3 sub3(real3 a, real3 b) { return make3(a.x - b.x, a.y - b.y, a.z - b.z); }
FN real3 mul3(real s, real3 a) { return make3(s * a.x, s * a.y, s * a.z); }
// s a + b
FN real3 fma3(real s, real3 a, real3 b) {
  return make3(fma(s, a.x, b.x), fma(s, a.y, b.y), fma(s, a.z, b.z));
}
FN real dot3(real3 a, real3 b) { return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z)); }
FN real3 cross3(real3 a, real3 b) {
  return make3(fma(a.y, b.z, -(a.z * b.y)), fma(a.z, b.x, -(a.x * b.z)),
               fma(a.x, b.y, -(a.y * b.x)));
}
// a x b + c
FN real3 cross_add3(real3 a, real3 b, real3 c) {
  return make3(fma(a.y, b.z, fma(-a.z, b.y, c.x)), fma(a.z, b.x, fma(-a.x, b.z, c.y)),
               fma(a.x, b.y, fma(-a.y, b.x, c.z)));
}
FN real3 pick3(mask m, real3 a, real3 b) {
  return make3(pick(m, a.x, b.x), pick(m, a.y, b.y), pick(m, a.z, b.z));
}
FN real norm3(real3 a) { return sqrt(dot3(a, a)); }
FN real3 unit3(real3 a) { return mul3(K(1) / larger(norm3(a), splat(TINY)), a); }

// Triple `i` of packed control data, the same for all lanes.
FN real3 load3(GLOBAL scalar* at, int i) {
  return make3(splat(at[3 * i]), splat(at[3 * i + 1]), splat(at[3 * i + 2]));
}

// The triple that begins at each lane's own index.
FN real3 gather3(GLOBAL scalar* at, real index) {
  return make3(gather(at, index), gather(at + 1, index), gather(at + 2, index));
}

// Reads `count` numbers from each lane's own index on, 8 at least, number i of all into to[i]. Rows
// of more than 8 lanes are not turned into columns, which takes longer than to gather each number.
FN void gather_columns(GLOBAL scalar* at, real index, int count, real* to) {
#if GLISS_LANES > 1 && GLISS_LANES <= 8 && !defined(__OPENCL_C_VERSION__)
  const scalar* from[GLISS_LANES];
  for (int i = 0; i < GLISS_LANES; ++i) from[i] = at + (int)index[i];
  gliss::lanes::load_columns(from, (ulong)count, to);
#else
  UNROLL_UP_TO(24)
  for (int i = 0; i < count; ++i) to[i] = gather(at + i, index);
#endif
}

#ifdef GLISS_PACKED
FN real3 load3(control_data at, int i) { return make3(at[3 * i], at[3 * i + 1], at[3 * i + 2]); }
FN real3 gather3(control_data at, real index) {
  real3 r;
  for (int i = 0; i < GLISS_LANES; ++i) {
    const control_data own = at + (int)index[i];
    r.x[i] = own[0][i];
    r.y[i] = own[1][i];
    r.z[i] = own[2][i];
  }
  return r;
}
#endif

// Three rows of `stride` numbers.
FN void store3(GLOBAL_OUT scalar* at, ulong stride, real3 a) {
  store_lanes(at, a.x);
  store_lanes(at + stride, a.y);
  store_lanes(at + 2 * stride, a.z);
}
