// Samples one patch on its way into the cache: does it fold, how sharply does it curve, how far
// does it reach? Lanes are probes; the result is the same for any number of them,
// because minima and maxima alone are kept, and NaN never is.

// Probes of a valence: its centre, then rings of a fan from there to the sides; ring r of L has n r
// points. Table, made on the host: xi of all, eta of all, each row filled up to a multiple of
// PROBE_PAD with the centre.
#define PROBE_PAD 16
#define PROBE_STRIDE(n) ((probe_count(n) + PROBE_PAD - 1) / PROBE_PAD * PROBE_PAD)
// Step of the differences that curvature is taken from; a power of two.
#define PROBE_STEP K(0x1p-17f)

FN int probe_levels(int n) { return n <= 8 ? 8 : n <= 32 ? 6 : n <= 128 ? 4 : 2; }
FN int probe_count(int n) { return 1 + n * probe_levels(n) * (probe_levels(n) + 1) / 2; }

typedef struct {
  real3 low, high, along_low, along_high, bend;
  real turn, curvature, stretch2, sag2, finite;
} patch_shape;

FN real3 smaller3(real3 a, real3 b) {
  return make3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}
FN real3 larger3(real3 a, real3 b) {
  return make3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z));
}

FN patch_shape widen(patch_shape s, real3 p, real3 normal, real3 tangent) {
  const real3 along = make3(dot3(p, tangent), dot3(p, cross3(normal, tangent)), dot3(p, normal));
  s.low = smaller3(p, s.low);
  s.high = larger3(p, s.high);
  s.along_low = smaller3(along, s.along_low);
  s.along_high = larger3(along, s.along_high);
  return s;
}

// n . (G_xixi, G_xieta, G_etaeta) from the derivatives of the unit normal (Weingarten).
FN real3 second_form(patch_point p, real3 n_xi, real3 n_eta) {
  return make3(-dot3(p.g_xi, n_xi), K(-0.5f) * (dot3(p.g_xi, n_eta) + dot3(p.g_eta, n_xi)),
               -dot3(p.g_eta, n_eta));
}

// |H| + sqrt(H^2 - K); infinite where the parametrisation is singular.
FN real largest_curvature(patch_point p, real3 second) {
  const real e = dot3(p.g_xi, p.g_xi), f = dot3(p.g_xi, p.g_eta), g = dot3(p.g_eta, p.g_eta);
  const real zero = splat(K(0)), det = e * g - f * f, inverse = K(1) / det;
  const real mean = (K(0.5f) * (e * second.z + g * second.x) - f * second.y) * inverse;
  const real gauss = (second.x * second.z - second.y * second.y) * inverse;
  const real apart = sqrt(larger(mean * mean - gauss, zero));
  return pick(det > zero, larger(mean, -mean) + apart, splat(K(INFINITY)));
}

// 0 where all three are finite, else NaN.
FN real zero_if_finite(real3 a) { return (a.x - a.x) + (a.y - a.y) + (a.z - a.z); }

// The least cosine at corners where the patch turns over, for probes do not come that close: where
// the boundary turns back, or by more than half a turn; and -1 where a cross tangent changes so
// fast (of a polygon in [-1, 1]^3) that it has no direction there. Of exact patches, whose boundary
// the other forms share.
#define TWIST_MOST K(32)
FN real corner_turn(GLOBAL scalar* control, GLOBAL scalar* corner, int n, real3 along) {
  real least = splat(K(1));
  for (int k = 0; k < n; ++k) {
    GLOBAL scalar* side = control + k * SIDE_REALS;
    GLOBAL scalar* before = control + wrap(k - 1, n) * SIDE_REALS;
    const real3 in = cubic_at(before, SIDE_C, splat(K(1))).d, out = load3(side, SIDE_C + 1),
                normal = cross3(in, out);
    const real turns_over = K(-1e-9f) * norm3(in) * norm3(out);
    least = pick(dot3(normal, load3(corner, 2 * k + 1)) < turns_over,
                 smaller(dot3(unit3(normal), along), least), least);
    const real twist = larger(norm3(load3(side, SIDE_TWIST_0)), norm3(load3(before, SIDE_TWIST_1)));
    least = pick(twist > TWIST_MOST, splat(K(-1)), least);
  }
  return least;
}

// `count` 0: of the base polygon alone.
FN_LARGE patch_shape examine(GLOBAL scalar* domain, GLOBAL scalar* probe, int count,
                             GLOBAL scalar* control, uint form, GLOBAL scalar* corner,
                             GLOBAL uint* triangle, GLOBAL scalar* frame, int n) {
  const real zero = splat(K(0)), one = splat(K(1)), far = splat(K(INFINITY));
  const real3 nothing = make3(zero, zero, zero), most = make3(far, far, far);
  const real3 along = load3(frame, FRAME_NORMAL), tangent = load3(frame, FRAME_TANGENT);
  patch_shape r = {
      most, sub3(nothing, most), most, sub3(nothing, most), nothing, one, zero, zero, zero, one};
  for (int k = 0; k < n; ++k) r = widen(r, load3(corner, 2 * k), along, tangent);
  if (count > 0 && form == FORM_PAPER) r.turn = corner_turn(control, corner, n, along);
  for (int first = 0; first < count; first += GLISS_LANES) {
    const real xi = load_lanes(probe + first), eta = load_lanes(probe + PROBE_STRIDE(n) + first);
    patch_point p;
    real3 normal[3];  // unit: here, a step along xi, a step along eta
    for (int i = 2; i >= 0; --i) {
      const scalar dxi = i == 1 ? PROBE_STEP : K(0), deta = i == 2 ? PROBE_STEP : K(0);
      p = evaluate_form(domain, control, form, n, xi + dxi, eta + deta);
      normal[i] = unit3(patch_normal(p));
    }
    const real over = splat(K(1) / PROBE_STEP);
    const real3 n_xi = mul3(over, sub3(normal[1], normal[0])),
                n_eta = mul3(over, sub3(normal[2], normal[0]));
    const real3 second = second_form(p, n_xi, n_eta);
    if (first == 0) r.bend = second;
    r = widen(r, p.g, along, tangent);
    r.turn = smaller(dot3(normal[0], along), r.turn);
    r.curvature = larger(largest_curvature(p, second), r.curvature);
    r.stretch2 = larger(dot3(p.g_xi, p.g_xi), r.stretch2);
    r.stretch2 = larger(dot3(p.g_eta, p.g_eta), r.stretch2);
    r.sag2 = larger(polygon_distance2(corner, triangle, n, p.g), r.sag2);
    r.finite = pick(zero_if_finite(p.g) + zero_if_finite(normal[0]) == zero, r.finite, zero);
  }
  return r;
}

// Over all lanes. 0 is added because which of 0 and -0 won depends on their number.
FN scalar least_lane(real a) {
  scalar r = lane(a, 0);
  for (int i = 1; i < GLISS_LANES; ++i) r = lane(a, i) < r ? lane(a, i) : r;
  return r + K(0);
}
FN scalar largest_lane(real a) {
  scalar r = lane(a, 0);
  for (int i = 1; i < GLISS_LANES; ++i) r = lane(a, i) > r ? lane(a, i) : r;
  return r + K(0);
}
FN void store_least(GLOBAL_OUT scalar* out, int i, real3 a) {
  out[3 * i] = least_lane(a.x);
  out[3 * i + 1] = least_lane(a.y);
  out[3 * i + 2] = least_lane(a.z);
}
FN void store_largest(GLOBAL_OUT scalar* out, int i, real3 a) {
  out[3 * i] = largest_lane(a.x);
  out[3 * i + 1] = largest_lane(a.y);
  out[3 * i + 2] = largest_lane(a.z);
}

FN void store_shape(GLOBAL_OUT scalar* out, patch_shape s) {
  store_least(out, SHAPE_LOW, s.low);
  store_largest(out, SHAPE_HIGH, s.high);
  store_least(out, SHAPE_ALONG_LOW, s.along_low);
  store_largest(out, SHAPE_ALONG_HIGH, s.along_high);
  out[3 * SHAPE_BEND] = lane(s.bend.x, 0);  // probe 0 is the centre
  out[3 * SHAPE_BEND + 1] = lane(s.bend.y, 0);
  out[3 * SHAPE_BEND + 2] = lane(s.bend.z, 0);
  out[SHAPE_TURN] = least_lane(s.turn);
  out[SHAPE_CURVATURE] = largest_lane(s.curvature);
  out[SHAPE_STRETCH2] = largest_lane(s.stretch2);
  out[SHAPE_SAG2] = largest_lane(s.sag2);
  out[SHAPE_FINITE] = least_lane(s.finite);
}
