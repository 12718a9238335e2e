// Samples one patch on its way into the cache: does it fold, how sharply does it curve, how far
// does it reach? Lanes are probes; the result is the same for any number of them,
// because minima and maxima alone are kept, and NaN never is.

// Probes of a valence: its centre, then rings of a fan from there to the sides; ring r of L has n r
// points. Table, made on the host: xi of all, eta of all, each row filled up to a multiple of
// PROBE_PAD with the centre. With up to PROBE_MOST_COARSE sides the coarse probes come first,
// filled up too: every other point of every other ring, then the rest of the outermost, where
// patches curve most. A gentle patch is sampled there alone.
#define PROBE_PAD 16
#define PROBE_PADDED(count) (((count) + PROBE_PAD - 1) / PROBE_PAD * PROBE_PAD)
#define PROBE_STRIDE(n) PROBE_PADDED(probe_count(n))
#define PROBE_MOST_COARSE 8
// Step of the differences that curvature is taken from; a power of two.
#define PROBE_STEP K(0x1p-17f)

FN int probe_levels(int n) { return n <= 8 ? 8 : n <= 32 ? 6 : n <= 128 ? 4 : 2; }
FN int probes_of_rings(int n, int rings) { return 1 + n * rings * (rings + 1) / 2; }
FN int coarse_probes(int n) {
  return probes_of_rings(n, probe_levels(n) / 2) + n * probe_levels(n) / 2;
}
FN int probe_coarse(int n) { return n <= PROBE_MOST_COARSE ? PROBE_PADDED(coarse_probes(n)) : 0; }
FN int probe_count(int n) {
  const int all = probes_of_rings(n, probe_levels(n)), coarse = probe_coarse(n);
  return coarse ? coarse + all - coarse_probes(n) : all;
}

typedef struct {
  real3 low, high, along_low, along_high, second_form;
  real least_cosine, curvature, stretch2, sag2, finite;
  int rings;  // that were sampled
} patch_shape;

FN real3 smaller3(real3 a, real3 b) {
  return make3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z));
}
FN real3 larger3(real3 a, real3 b) {
  return make3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z));
}

// Along tangent, normal x tangent and normal of the base polygon.
FN real3 along_frame(real3 p, real3 normal, real3 tangent) {
  return make3(dot3(p, tangent), dot3(p, cross3(normal, tangent)), dot3(p, normal));
}

FN patch_shape widen(patch_shape s, real3 p, real3 along) {
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
// fast (of a polygon in [-1, 1]^3) that it has no direction there. `reals`: numbers of a side, of
// the forms that blend sides; the others have boundaries that were examined so before.
#define TWIST_MOST K(32)
FN real least_corner_cosine(GLOBAL scalar* control, int reals, GLOBAL scalar* corner, int n,
                            real3 along) {
  real least = splat(K(1));
  for (int k = 0; k < n; ++k) {
    GLOBAL scalar* side = control + k * reals;
    GLOBAL scalar* before = control + wrap(k - 1, n) * reals;
    const real3 in = cubic_at(before, SIDE_C, splat(K(1))).d, out = load3(side, SIDE_C + 1),
                normal = cross3(in, out);
    const real inverted_below = K(-1e-9f) * norm3(in) * norm3(out);
    least = pick(dot3(normal, load3(corner, 2 * k + 1)) < inverted_below,
                 smaller(dot3(unit3(normal), along), least), least);
    const real twist = larger(norm3(load3(side, SIDE_TWIST_0)), norm3(load3(before, SIDE_TWIST_1)));
    least = pick(twist > TWIST_MOST, splat(K(-1)), least);
  }
  return least;
}

// The place in the table of point i of a ring (1 to probe_levels).
FN int probe_place(int n, int ring, int i) {
  const int inner = probes_of_rings(n, ring - 1), first = probe_coarse(n);
  if (!first) return inner + i;
  const int fan = i / ring, along = i % ring, halfway = ring / 2, is_even = ring % 2 == 0;
  if (is_even && along % 2 == 0) return probes_of_rings(n, halfway - 1) + fan * halfway + along / 2;
  if (ring == probe_levels(n)) return probes_of_rings(n, halfway) + i / 2;
  const int before = inner - probes_of_rings(n, (ring - 1) / 2);
  return first + before + (is_even ? i / 2 : i);
}

// A probe: the patch, its unit normal and its second fundamental form.
typedef struct {
  patch_point p;
  real3 normal, second;
} patch_probe;

FN patch_probe probe_of(patch_jet g) {
  patch_probe r;
  r.p = g.p;
  r.normal = unit3(patch_normal(g.p));
  r.second = make3(dot3(r.normal, g.xixi), dot3(r.normal, g.xieta), dot3(r.normal, g.etaeta));
  return r;
}

// Probes by second derivatives where `table` has them (second.h), else by differences.
FN_LARGE patch_probe probe_patch(GLOBAL scalar* domain, GLOBAL scalar* control, uint form, int n,
                                 real xi, real eta, GLOBAL scalar* table) {
  if (table && IS_FORM(form, FORM_SEXTIC))
    return probe_of(triangle_jet(domain, control, table, PROBE_STRIDE(3)));
  if (table && IS_FORM(form, FORM_BEZIER))
    return probe_of(quad_jet(control, xi, eta, table, PROBE_STRIDE(4)));
  if (table && IS_FORM(form, FORM_CURVED))
    return probe_of(curved_jet(domain, control, n, xi, eta, table, PROBE_STRIDE(n)));
  if (table) return probe_of(blend_jet(control, form, n, table, PROBE_STRIDE(n)));
  patch_probe r;
  real3 normal[3];  // unit: here, a step along xi, a step along eta
  for (int i = 2; i >= 0; --i) {
    const scalar dxi = i == 1 ? PROBE_STEP : K(0), deta = i == 2 ? PROBE_STEP : K(0);
    r.p = evaluate_form(domain, control, form, n, xi + dxi, eta + deta);
    normal[i] = unit3(patch_normal(r.p));
  }
  const real over = splat(K(1) / PROBE_STEP);
  r.normal = normal[0];
  r.second = second_form(r.p, mul3(over, sub3(normal[1], normal[0])),
                         mul3(over, sub3(normal[2], normal[0])));
  return r;
}

// A triangle's corner, two of its sides and the vectors that take a point to its coordinates along
// them.
typedef struct {
  real3 a, ab, ac, to_b, to_c;
} triangle_frame;

FN triangle_frame triangle_frame_of(real3 a, real3 b, real3 c) {
  triangle_frame t;
  t.a = a;
  t.ab = sub3(b, a);
  t.ac = sub3(c, a);
  const real e = dot3(t.ab, t.ab), f = dot3(t.ab, t.ac), g = dot3(t.ac, t.ac);
  const real over = K(1) / (e * g - f * f);
  t.to_b = mul3(over, sub3(mul3(g, t.ab), mul3(f, t.ac)));
  t.to_c = mul3(over, sub3(mul3(e, t.ac), mul3(f, t.ab)));
  return t;
}

// Squared distance of x to a point of the triangle: the nearest one where its foot lies inside.
FN real near_triangle2(const triangle_frame* t, real3 x) {
  const real zero = splat(K(0)), one = splat(K(1));
  const real3 away = sub3(x, t->a);
  const real v = larger(smaller(dot3(away, t->to_b), one), zero),
             w = larger(smaller(dot3(away, t->to_c), one - v), zero);
  const real3 rest = fma3(-v, t->ab, fma3(-w, t->ac, away));
  return dot3(rest, rest);
}

// Squared distances of probes to the base polygon, the largest of them.
#define SAG_TRIANGLES (UNROLLED_VALENCE - 2)
typedef struct {
  triangle_frame triangle[SAG_TRIANGLES];
  int count;  // 0: more than these
} sag_frame;

FN sag_frame sag_frame_of(GLOBAL scalar* corner, GLOBAL uint* triangle, int n) {
  sag_frame s;
  s.count = n - 2 <= SAG_TRIANGLES ? n - 2 : 0;
  for (int t = 0; t < s.count; ++t) {
    s.triangle[t] = triangle_frame_of(load3(corner, 2 * (int)triangle[3 * t]),
                                      load3(corner, 2 * (int)triangle[3 * t + 1]),
                                      load3(corner, 2 * (int)triangle[3 * t + 2]));
  }
  return s;
}

// Looks for the nearest point only where a point of the polygon that is quickly found is farther
// than the largest distance so far.
FN real larger_sag2(real sag2, const sag_frame* s, GLOBAL scalar* corner, GLOBAL uint* triangle,
                    int n, real3 x) {
  real near = splat(K(INFINITY));
  for (int t = 0; t < s->count; ++t) near = smaller(near_triangle2(s->triangle + t, x), near);
  if (!any(near > sag2)) return sag2;
  return larger(smaller(near, polygon_distance2(corner, triangle, n, x)), sag2);
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

// A gentle patch keeps near its base polygon's direction, and turns so little (rad) from a probe to
// the next that these tell of what lies between: a fold would have to curve nine times as much as
// they do. Triangles that blend sides bend most between the coarse probes at their corners.
#define GENTLE_TURN K(0.1875f)
FN int is_gentle(patch_shape s, uint form, int n, int rings) {
  if (n == 3 && BLENDS_SIDES(form)) return 0;
  const scalar curvature = largest_lane(s.curvature),
               stretch2 = largest_lane(s.stretch2) / (scalar)(rings * rings);
  return least_lane(s.least_cosine) > K(GENTLE_COSINE) && least_lane(s.finite) > K(0) &&
         stretch2 * curvature * curvature < GENTLE_TURN * GENTLE_TURN;
}

// `count` 0: of the base polygon alone. `coarse`: after so many probes a gentle patch needs no
// more, or 0. `table`: null, or that of second.h. `rows`: null, or where samples go for tiles to be
// cut from (cut.h).
FN_LARGE patch_shape examine(GLOBAL scalar* domain, GLOBAL scalar* probe, int coarse, int count,
                             GLOBAL scalar* control, uint form, GLOBAL scalar* corner,
                             GLOBAL uint* triangle, GLOBAL scalar* frame, int n,
                             GLOBAL scalar* table, GLOBAL_OUT scalar* rows) {
  const real zero = splat(K(0)), one = splat(K(1)), far = splat(K(INFINITY));
  const real3 nothing = zero3(), most = make3(far, far, far);
  const real3 normal = load3(frame, FRAME_NORMAL), tangent = load3(frame, FRAME_TANGENT);
  const sag_frame base = sag_frame_of(corner, triangle, n);
  patch_shape r = {
      most, sub3(nothing, most), most, sub3(nothing, most), nothing, one, zero, zero, zero,
      one,  probe_levels(n)};
  for (int k = 0; k < n; ++k) {
    const real3 p = load3(corner, 2 * k);
    r = widen(r, p, along_frame(p, normal, tangent));
  }
  if (count > 0 && (IS_FORM(form, FORM_PAPER) || IS_FORM(form, FORM_RIBBON)))
    r.least_cosine = least_corner_cosine(control, side_reals(form), corner, n, normal);
  for (int first = 0; first < count; first += GLISS_LANES) {
    if (first > 0 && first == coarse && is_gentle(r, form, n, r.rings / 2)) {
      r.rings /= 2;
      break;
    }
    const real xi = load_lanes(probe + first), eta = load_lanes(probe + PROBE_STRIDE(n) + first);
    const patch_probe at =
        probe_patch(domain, control, form, n, xi, eta, table ? table + first : 0);
    const real3 along = along_frame(at.p.g, normal, tangent);
    if (first == 0) r.second_form = at.second;
    r = widen(r, at.p.g, along);
    r.least_cosine = smaller(dot3(at.normal, normal), r.least_cosine);
    r.curvature = larger(largest_curvature(at.p, at.second), r.curvature);
    r.stretch2 = larger(dot3(at.p.g_xi, at.p.g_xi), r.stretch2);
    r.stretch2 = larger(dot3(at.p.g_eta, at.p.g_eta), r.stretch2);
    r.sag2 = larger_sag2(r.sag2, &base, corner, triangle, n, at.p.g);
    r.finite = pick(zero_if_finite(at.p.g) + zero_if_finite(at.normal) == zero, r.finite, zero);
    if (rows) {
      store3(rows + first, (ulong)PROBE_STRIDE(n), along);
      store3(rows + 3 * PROBE_STRIDE(n) + first, (ulong)PROBE_STRIDE(n),
             along_frame(at.normal, normal, tangent));
    }
  }
  return r;
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
  out[3 * SHAPE_SECOND_FORM] = lane(s.second_form.x, 0);  // probe 0 is the centre
  out[3 * SHAPE_SECOND_FORM + 1] = lane(s.second_form.y, 0);
  out[3 * SHAPE_SECOND_FORM + 2] = lane(s.second_form.z, 0);
  out[SHAPE_LEAST_COSINE] = least_lane(s.least_cosine);
  out[SHAPE_CURVATURE] = largest_lane(s.curvature);
  out[SHAPE_STRETCH2] = largest_lane(s.stretch2);
  out[SHAPE_SAG2] = largest_lane(s.sag2);
  out[SHAPE_FINITE] = least_lane(s.finite);
  out[SHAPE_RINGS] = (scalar)s.rings;
}
