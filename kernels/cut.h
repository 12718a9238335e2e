// Cuts a patch into tiles (tile.h). Lanes are tiles. On the host only, in double (tile_code.h).
//
// A tile's bounds are from samples, CUT_RINGS or CUT_FEW_RINGS to a side, widened by what may lie
// between them. Its points are those of a triangle of so many rows: (a, b), b <= a, is point
// a (a + 1) / 2 + b. Between them lie small triangles, most of them turned as the tile is, (a, b),
// (a + 1, b), (a + 1, b + 1), and some the other way, (a, b), (a, b + 1), (a + 1, b + 1).

// Local: what curves more has no end of it.
#define CUT_MOST_CURVATURE K(1e4f)
// Curvatures range so much farther between samples than at them.
#define CUT_MORE_CURVATURE K(0.5f)
// The tangent of 2e-3 rad, by which a bound on normals is widened: more than what two patches that
// meet smoothly differ by.
#define CUT_LEAST_TURN K(0x1.0624f4172ce6ep-9)

FN real gather_each(GLOBAL scalar* at, GLOBAL uint* index) {
  real r = {};
  for (int i = 0; i < GLISS_LANES; ++i) r[i] = at[index[i]];
  return r;
}
FN real3 gather_triple(GLOBAL scalar* at, ulong stride, GLOBAL uint* index) {
  return make3(gather_each(at, index), gather_each(at + stride, index),
               gather_each(at + 2 * stride, index));
}

// One sample of each lane.
typedef struct {
  real3 p, n;
} cut_sample;

FN cut_sample cut_sample_of(patch_point p, GLOBAL scalar* frame) {
  const real3 normal = load3(frame, FRAME_NORMAL), tangent = load3(frame, FRAME_TANGENT),
              aside = cross3(normal, tangent), n = unit3(patch_normal(p));
  const cut_sample s = {make3(dot3(p.g, tangent), dot3(p.g, aside), dot3(p.g, normal)),
                        make3(dot3(n, tangent), dot3(n, aside), dot3(n, normal))};
  return s;
}

// Samples of a patch at `count` points, a multiple of CUT_PAD, as CUT_ROWS rows. Returns the
// largest squared length of G_xi and G_eta.
FN_LARGE scalar sample_patch(GLOBAL scalar* domain, GLOBAL scalar* control, uint form,
                             GLOBAL scalar* frame, int n, GLOBAL scalar* xi, GLOBAL scalar* eta,
                             int count, GLOBAL_OUT scalar* rows) {
  real stretch2 = splat(K(0));
  for (int i = 0; i < count; i += GLISS_LANES) {
    const patch_point p =
        evaluate_form(domain, control, form, n, load_lanes(xi + i), load_lanes(eta + i));
    const cut_sample s = cut_sample_of(p, frame);
    store3(rows + i, (ulong)count, s.p);
    store3(rows + 3 * count + i, (ulong)count, s.n);
    stretch2 = larger(dot3(p.g_xi, p.g_xi), stretch2);
    stretch2 = larger(dot3(p.g_eta, p.g_eta), stretch2);
  }
  return largest_lane(stretch2);
}

// The least cosine between a normal of a tile and the mean of the tile's, over all tiles. `index`:
// [point][tile], where the samples stand.
FN_LARGE scalar least_cosine(GLOBAL scalar* rows, int stride, GLOBAL uint* index, int points,
                             int tiles) {
  GLOBAL scalar* normals = rows + 3 * stride;
  real least = splat(K(1));
  for (int first = 0; first < tiles; first += GLISS_LANES) {
    real3 n[CUT_POINTS(CUT_RINGS)], sum = zero3();
    for (int i = 0; i < points; ++i) {
      n[i] = gather_triple(normals, (ulong)stride, index + i * tiles + first);
      sum = add3(sum, n[i]);
    }
    const real3 mean = unit3(sum);
    for (int i = 0; i < points; ++i) least = smaller(dot3(n[i], mean), least);
  }
  return least_lane(least);
}

// The findings of a tile's small triangles.
typedef struct {
  // Principal curvatures, positive where the surface bends away from its normal: the range of the
  // lesser ones and that of the others.
  real low, low_most, high_least, high;
  real slack2;           // squared distance that the surface may leave its triangles by
  real3 same, opposite;  // sums of n . (G_uu, G_uv, G_vv) along the sides of either kind
} tile_curvatures;

// By the turn of the normals along two sides (Rusinkiewicz 2004).
FN tile_curvatures add_curvature(tile_curvatures t, int is_same, cut_sample a, cut_sample b,
                                 cut_sample c) {
  const real3 u = sub3(b.p, a.p), v = sub3(c.p, a.p), change_u = sub3(b.n, a.n),
              change_v = sub3(c.n, a.n);
  const real e = dot3(u, u), f = dot3(u, v), g = dot3(v, v), det = e * g - f * f;
  const real l = dot3(change_u, u), m = K(0.5f) * (dot3(change_u, v) + dot3(change_v, u)),
             n = dot3(change_v, v);
  const real inverse = K(1) / det;
  const real mean = K(0.5f) * (e * n - K(2) * f * m + g * l) * inverse,
             gauss = (l * n - m * m) * inverse;
  const real apart = sqrt(larger(mean * mean - gauss, splat(K(0))));
  const real longest2 = larger(larger(e, g), e + g - K(2) * f);
  const real most = splat(CUT_MOST_CURVATURE);
  const mask is_sound = det > K(1e-12f) * longest2 * longest2;
  const real low = pick(is_sound, mean - apart, -most), high = pick(is_sound, mean + apart, most);
  t.low = smaller(low, t.low);
  t.low_most = larger(low, t.low_most);
  t.high_least = smaller(high, t.high_least);
  t.high = larger(high, t.high);
  // (spacing)^2 curvature / 8, and half as much again for curvature between samples.
  const real away = longest2 * larger(-low, high) * K(1.5f / 8);
  t.slack2 = larger(smaller(longest2, away * away), t.slack2);
  const real3 second = make3(l, m, n);
  if (is_same) {
    t.same = sub3(t.same, second);
  } else {
    t.opposite = sub3(t.opposite, second);
  }
  return t;
}

FN tile_curvatures curvatures_of(const cut_sample* s, int rings) {
  const real zero = splat(K(0)), far = splat(K(INFINITY));
  const real3 none = zero3();
  tile_curvatures t = {far, -far, far, -far, zero, none, none};
  for (int a = 0; a < rings; ++a) {
    for (int b = 0; b <= a; ++b) {
      const cut_sample *here = s + a * (a + 1) / 2 + b, *next = s + (a + 1) * (a + 2) / 2 + b;
      t = add_curvature(t, 1, here[0], next[0], next[1]);
      if (b < a) t = add_curvature(t, 0, here[0], here[1], next[1]);
    }
  }
  return t;
}

// Normals may turn so much more between samples: a quarter of what the samples do.
#define CUT_MORE_TURN K(0.25f)

// The tangent of an angle that no normal exceeds, where `least` is the least cosine: five quarters
// of what the samples turn, and a little. Infinite from a right angle on.
FN real lean_tangent_of(real least) {
  const real zero = splat(K(0)), one = splat(K(1));
  const real c = smaller(larger(least, zero), one), s = sqrt((one - c) * (one + c));
  // The tangents of the angle and of a quarter of it.
  const real half = sqrt(K(0.5f) * (one + c)), t = s / larger(c, splat(K(1e-6f))),
             quarter = s / (K(2) * half * (one + half));
  const real under = one - t * quarter, turn = (t + quarter) / under;
  const real rest = one - turn * CUT_LEAST_TURN;
  return pick((under > zero) & (rest > zero), (turn + CUT_LEAST_TURN) / rest, splat(K(INFINITY)));
}

// n . (G_xixi, G_xieta, G_etaeta) from those along two sides; rows of `m`: the domain's vectors in
// the sides.
FN real3 along_domain_of(real3 s, GLOBAL scalar* m, ulong stride) {
  const real a = load_lanes(m), b = load_lanes(m + stride), c = load_lanes(m + 2 * stride),
             d = load_lanes(m + 3 * stride);
  const real p = fma(a, s.x, c * s.y), q = fma(a, s.y, c * s.z), r = fma(b, s.x, d * s.y),
             t = fma(b, s.y, d * s.z);
  return make3(fma(a, p, c * q), fma(b, p, d * q), fma(b, r, d * t));
}

// The box that tiles are written in, and what they are measured by.
typedef struct {
  real3 low, step;
  real unit;     // of radii and heights
  real stretch;  // the longest of G_xi and G_eta
} cut_frame;

FN cut_frame cut_frame_of(GLOBAL scalar* box, scalar stretch2) {
  cut_frame f;
  f.low = load3(box, 0);
  f.step = mul3(splat(K(1) / K(65535)), sub3(load3(box, 1), f.low));
  f.unit = K(2) * larger(larger(f.step.x, f.step.y), f.step.z);
  f.stretch = sqrt(splat(stretch2));
  return f;
}

// Words but for the curvatures and for how far normals lean, which have to wait for the largest
// curvature: `low` and `high` are the tile's, `lean` the tangent of an angle that no normal
// exceeds, `residual` what leans differ by from what the mean of `low` and `high` says, `radius`
// the cylinder's, below 0 where the axis is turned over.
typedef struct {
  real word[TILE_UINTS], low, high, lean, residual, radius, most;
} cut_tile;

FN cut_tile cut_tile_of(const cut_sample* s, int rings, cut_frame f, GLOBAL scalar* transform,
                        ulong stride) {
  const int points = CUT_POINTS(rings);
  const real zero = splat(K(0)), far = splat(K(INFINITY));
  real3 sum = zero3(), middle = sum;
  for (int i = 0; i < points; ++i) {
    sum = add3(sum, s[i].n);
    middle = add3(middle, s[i].p);
  }
  const mask is_down = sum.z < zero;
  sum = pick3(is_down, sub3(zero3(), sum), sum);
  const real3 up = unit3(sum);
  const real axis_x = axis_code(up.x), axis_y = axis_code(up.y);
  const real3 axis = axis_of_codes(axis_x, axis_y);
  middle = mul3(splat(K(1) / K(points)), middle);
  real least = splat(K(1)), top = -far, bottom = far;
  for (int i = 0; i < points; ++i) {
    const real along = dot3(s[i].n, axis), cosine = pick(is_down, -along, along),
               height = dot3(sub3(s[i].p, middle), axis);
    least = pick(cosine >= least, least, pick(cosine == cosine, cosine, -splat(K(1))));
    top = larger(height, top);
    bottom = smaller(height, bottom);
  }
  const real3 at = fma3(K(0.5f) * (top + bottom), axis, middle);
  const real3 code =
      make3(centre_code(at.x, f.low.x, f.step.x), centre_code(at.y, f.low.y, f.step.y),
            centre_code(at.z, f.low.z, f.step.z));
  const real3 centre =
      make3(centre_of_code(code.x, f.low.x, f.step.x), centre_of_code(code.y, f.low.y, f.step.y),
            centre_of_code(code.z, f.low.z, f.step.z));
  const tile_curvatures curvatures = curvatures_of(s, rings);
  // The outermost samples are not quite on the sides.
  const real slack = sqrt(curvatures.slack2) + K(2e-5f) * f.stretch;
  const real low = curvatures.low - CUT_MORE_CURVATURE * (curvatures.low_most - curvatures.low),
             high =
                 curvatures.high + CUT_MORE_CURVATURE * (curvatures.high - curvatures.high_least);
  cut_tile r;
  r.most = larger(-curvatures.low, curvatures.high);
  r.low = pick(is_down, -high, low);
  r.high = pick(is_down, -low, high);
  const real mean = K(0.5f) * (r.low + r.high);
  real half = zero, radius2 = zero, residual2 = zero;
  for (int i = 0; i < points; ++i) {
    const real3 away = sub3(s[i].p, centre);
    const real height = dot3(away, axis);
    const real3 aside = fma3(-height, axis, away);
    const real3 normal = mul3(K(1) / dot3(s[i].n, axis), s[i].n),
                residual = sub3(normal, fma3(mean, aside, axis));
    half = larger(fabs(height), half);
    radius2 = larger(dot3(aside, aside), radius2);
    residual2 = larger(dot3(residual, residual), residual2);
  }
  r.lean = lean_tangent_of(least);
  r.residual = sqrt(residual2);
  r.radius = sqrt(radius2) + slack;
  r.word[TILE_CENTRE_XY] = halves_code(code.x, code.y);
  r.word[TILE_CENTRE_Z_RADIUS] = halves_code(code.z, length_code(r.radius, f.unit));
  r.radius = pick(is_down, -r.radius, r.radius);
  r.word[TILE_AXIS] = fma(axis_y, splat(K(4096)), axis_x);
  r.word[TILE_HALF_CURVES] = length_code(half + slack, f.unit);
  const real3 second = add3(along_domain_of(curvatures.same, transform, stride),
                            along_domain_of(curvatures.opposite, transform + 4 * stride, stride));
  // The mean of rings^2 small triangles, whose sides are CUT_RINGS / rings of those that the
  // transforms are for.
  r.word[TILE_SECOND_FORM] = second_code(mul3(splat(K(1) / K(CUT_RINGS * CUT_RINGS)), second));
  return r;
}

FN scalar cut_by(int rings, GLOBAL scalar* rows, int stride, GLOBAL uint* index,
                 GLOBAL scalar* transforms, int tiles, GLOBAL scalar* box, scalar stretch2,
                 scalar curvature, GLOBAL_OUT scalar* out) {
  const cut_frame frame = cut_frame_of(box, stretch2);
  real most = splat(curvature);
  for (int first = 0; first < tiles; first += GLISS_LANES) {
    cut_sample s[CUT_POINTS(CUT_RINGS)];
    for (int i = 0; i < CUT_POINTS(rings); ++i) {
      GLOBAL uint* at = index + i * tiles + first;
      s[i].p = gather_triple(rows, (ulong)stride, at);
      s[i].n = gather_triple(rows + 3 * stride, (ulong)stride, at);
    }
    const cut_tile t = cut_tile_of(s, rings, frame, transforms + first, (ulong)tiles);
    for (int i = 0; i < TILE_UINTS; ++i) store_lanes(out + i * tiles + first, t.word[i]);
    const real later[] = {t.low, t.high, t.lean, t.residual, t.radius};
    for (int i = 0; i < CUT_OUT_ROWS - (int)TILE_UINTS; ++i)
      store_lanes(out + (TILE_UINTS + i) * tiles + first, later[i]);
    most = larger(t.most, most);
  }
  return largest_lane(most);
}

// The tiles of a patch from its samples, `rings` to a tile's side, `tiles` a multiple of CUT_PAD.
// Returns the largest curvature of all, local, at least `curvature`; the words have no curvatures
// yet.
FN_LARGE scalar cut_patch(GLOBAL scalar* rows, int stride, GLOBAL uint* index, int rings,
                          GLOBAL scalar* transforms, int tiles, GLOBAL scalar* box, scalar stretch2,
                          scalar curvature, GLOBAL_OUT scalar* out) {
  return rings == CUT_RINGS ? cut_by(CUT_RINGS, rows, stride, index, transforms, tiles, box,
                                     stretch2, curvature, out)
                            : cut_by(CUT_FEW_RINGS, rows, stride, index, transforms, tiles, box,
                                     stretch2, curvature, out);
}

// Returns the code of a bound on how far normals lean from the axis. Where it is tighter beneath
// the patch, the bound is on what they lean beyond the mean curvature as it is read.
FN real lean_bits(cut_tile t, real mean) {
  const real zero = splat(K(0)), radius = larger(t.radius, -t.radius);
  const real residual = fma(radius, fabs(mean - K(0.5f) * (t.low + t.high)), t.residual);
  const real more = larger((K(1) + CUT_MORE_TURN) * residual,
                           fma(splat(K(0.5f) * CUT_MORE_TURN), t.lean, residual)) +
                    CUT_LEAST_TURN;
  const mask bends =
      (t.lean < splat(K(INFINITY))) & (more < t.lean) & (fma(-t.radius, mean, more) < t.lean);
  return lean_code(pick(bends, more, t.lean)) +
         pick(bends, splat(K(TILE_LEANS_BY_CURVATURE)), zero);
}

// Adds what the words lack to those that are in `out`; curvatures are relative to `curvature`.
FN_LARGE void write_curves(GLOBAL_OUT scalar* out, int tiles, scalar curvature) {
  const real over = splat(K(1) / curvature);
  for (int first = 0; first < tiles; first += GLISS_LANES) {
    GLOBAL_OUT scalar *at = out + first, *later = at + TILE_UINTS * tiles;
    cut_tile t;
    t.low = load_lanes(later);
    t.high = load_lanes(later + tiles);
    t.lean = load_lanes(later + 2 * tiles);
    t.residual = load_lanes(later + 3 * tiles);
    t.radius = load_lanes(later + 4 * tiles);
    const real low = curvature_code(t.low * over, 0), high = curvature_code(t.high * over, 1);
    const real mean = K(0.5f) * (curvature_of_code(low, splat(curvature)) +
                                 curvature_of_code(high, splat(curvature)));
    GLOBAL_OUT scalar *word = at + TILE_HALF_CURVES * tiles, *axis = at + TILE_AXIS * tiles;
    store_lanes(word, fma(high, splat(K(0x1p24f)), fma(low, splat(K(65536)), load_lanes(word))));
    store_lanes(axis, fma(lean_bits(t, mean), splat(K(0x1p24f)), load_lanes(axis)));
  }
}
