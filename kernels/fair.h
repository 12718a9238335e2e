// The fair construction: sides that curve no more than their polygons ask for, the Gregory triangle
// between three of them and the Gregory quad between four. On the host only; lanes are sides, or
// patches of one valence.
//
// A side knows its two ends alone, as in the paper, but for what it shares with the face beyond: at
// a vertex all sides have the curvature and the twist of one shape operator (solve_fit), so that
// their curves are of degree 5 and their normals of degree 3 (fair_side). Between two quads curves
// are cubic and normals quadratic: there the shape operators say how the normal turns at mid-side
// (mid_normal_of). Normals along a side are those of C' x T for T = k C' + h m, as in ribbon.h, so
// that patches join with G1 continuity whatever k and h are.

// How much sides bend and twist for the vertex's sake: beyond, they do more harm than good. A shape
// operator holds as far as the shortest side goes that it was fit to. A side that is more than
// FAIR_REACH times as long bends and twists less for it, in proportion; but always by a quarter of
// what its tangents hold it off its chord, and by half of what its normals turn. Between two quads
// a mid-side normal turns by at most FAIR_MOST_SMOOTH_TURN (rad).
#define FAIR_MOST_BEND K(2.5f)
#define FAIR_REACH K(4)
#define FAIR_MOST_TWIST K(1.25f)
#define FAIR_MOST_SMOOTH_TURN K(0.15625f)
// The least cosine between a corner's normal and the face's that counts in full (fair_middle).
#define FAIR_STEEP K(0.25f)

FN real clamp_to(real x, real most) { return larger(smaller(x, most), -most); }

// A cubic curve with a normal at each end: what is known of a side before its vertices are.
typedef struct {
  real3 p0, p1, n0, n1;  // ends
  real3 edge, t0, t1;    // p1 - p0, C'(0), C'(1)
  real sound;
} fair_curve;

// Tangents of eq. 7 and 8. `by_arc`: as long as those of the circle with their directions, which is
// longer than the edge, whose length they have in the paper. At a crease `own` are those that both
// faces share.
FN fair_curve fair_curve_of(corner start, corner end, mask by_arc, crease_tangents own) {
  fair_curve r;
  r.p0 = start.p;
  r.p1 = end.p;
  r.n0 = start.n;
  r.n1 = end.n;
  const side_ends ends = side_ends_of(start, end);
  r.edge = ends.edge;
  const mask is_own = has_tangents(own);
  r.sound = pick(is_own, smaller(norm3(ends.m0), norm3(ends.me)), ends.sound);
  const real one = splat(K(1)), cosine = dot3(unit3(ends.ts), unit3(ends.te));
  const real arc = K(2) / (one + sqrt(larger(K(0.5f) * (one + cosine), splat(K(0))))),
             longer = pick(by_arc, arc, one);
  r.t0 = pick3(is_own, own.start, mul3(longer, ends.ts));
  r.t1 = pick3(is_own, own.end, mul3(longer, ends.te));
  return r;
}

// C''(0) and C''(1).
FN real3 second_at_start(fair_curve c) {
  const real two = splat(K(2)), four = splat(K(4)), six = splat(K(6));
  return sub3(mul3(six, c.edge), fma3(four, c.t0, mul3(two, c.t1)));
}
FN real3 second_at_end(fair_curve c) {
  const real two = splat(K(2)), four = splat(K(4)), six = splat(K(6));
  return sub3(fma3(two, c.t0, mul3(four, c.t1)), mul3(six, c.edge));
}

// A symmetric operator on the plane across a vertex's normal: what the normal turns by along a
// tangent.
typedef struct {
  real3 x, y;       // unit tangents
  real xx, xy, yy;  // the operator in them
  real reach;       // the length of the shortest side that it was fit to
} shape_operator;

FN real3 normal_change_along(shape_operator s, real3 t) {
  const real x = dot3(t, s.x), y = dot3(t, s.y);
  return fma3(fma(s.xx, x, s.xy * y), s.x, mul3(fma(s.xy, x, s.yy * y), s.y));
}

// Least squares over the sides that leave a vertex: t'S t = kappa and b'S t = tau along each.
typedef struct {
  real3 x, y;
  real m[6], v[3];  // normal equations: xx, x y, x z, yy, yz, zz; right-hand side
  real count;       // of the sides
  real reach;       // the length of the shortest
} shape_fit;

FN shape_fit start_fit(real3 normal, real3 tangent) {
  shape_fit f = {};
  f.x = unit3(fma3(-dot3(tangent, normal), normal, tangent));
  f.y = cross3(normal, f.x);
  f.reach = splat(K(INFINITY));
  return f;
}

FN void add_row(shape_fit* f, real a, real b, real c, real value) {
  f->m[0] = fma(a, a, f->m[0]);
  f->m[1] = fma(a, b, f->m[1]);
  f->m[2] = fma(a, c, f->m[2]);
  f->m[3] = fma(b, b, f->m[3]);
  f->m[4] = fma(b, c, f->m[4]);
  f->m[5] = fma(c, c, f->m[5]);
  f->v[0] = fma(a, value, f->v[0]);
  f->v[1] = fma(b, value, f->v[1]);
  f->v[2] = fma(c, value, f->v[2]);
}

// The bend and the twist of a side where it begins, along its direction in two tangents.
typedef struct {
  real x, y, bend, twist;
} side_shape;

FN side_shape side_shape_of(fair_curve side, real3 x, real3 y) {
  const real speed = larger(norm3(side.t0), splat(TINY));
  const real3 t = mul3(K(1) / speed, side.t0), b = cross3(side.n0, t);
  const side_shape r = {dot3(t, x), dot3(t, y),
                        -dot3(side.n0, second_at_start(side)) / (speed * speed),
                        dot3(b, sub3(side.n1, side.n0)) / speed};
  return r;
}

FN void add_side(shape_fit* f, side_shape s) {
  add_row(f, s.x * s.x, K(2) * s.x * s.y, s.y * s.y, s.bend);
  add_row(f, -s.x * s.y, s.x * s.x - s.y * s.y, s.x * s.y, s.twist);
}

// By Cholesky; a little is added to the diagonal, for sides that do not span all directions.
FN shape_operator solve_fit(shape_fit f) {
  const real more = K(0x1p-44f) * f.count;
  const real l0 = sqrt(f.m[0] + more), l1 = f.m[1] / l0, l2 = f.m[2] / l0;
  const real l3 = sqrt(f.m[3] + more - l1 * l1), l4 = (f.m[4] - l1 * l2) / l3;
  const real l5 = sqrt(f.m[5] + more - l2 * l2 - l4 * l4);
  const real a = f.v[0] / l0, b = (f.v[1] - l1 * a) / l3, c = (f.v[2] - l2 * a - l4 * b) / l5;
  const real z = c / l5, y = (b - l4 * z) / l3, x = (a - l1 * y - l2 * z) / l0;
  const shape_operator s = {f.x, f.y, x, y, z, f.reach};
  return s;
}

// The changes that a shape operator asks of the end of a side: of its curve along the normal, and
// of its normal across the curve.
typedef struct {
  real bend, twist;
} fair_change;

// The lengths of both end tangents across the edge's direction. Cubic, the curve is an eighth of
// that off its chord.
FN real lean_of(fair_curve c, real3 e) { return norm3(cross3(c.t0, e)) + norm3(cross3(c.t1, e)); }

// Those of the start, 0, or the end, 1, of a curve; `e`: the edge's direction, `lean`: of both
// tangents to it. As n_c = C' x (n x e), the change of n has to be measured along n x e, which is
// not quite across C'.
FN fair_change fair_change_of(fair_curve c, shape_operator s, int end, real3 e, real lean,
                              real most_twist) {
  const real3 own = sub3(c.n1, c.n0);
  const real3 n = end ? c.n1 : c.n0, t = end ? c.t1 : c.t0,
              second = end ? second_at_end(c) : second_at_start(c);
  const real3 asked = normal_change_along(s, t), m = cross3(n, e);
  const real length = norm3(t), held = smaller(splat(K(1)), FAIR_REACH * s.reach / length),
             most_bend = FAIR_MOST_BEND * length;
  const fair_change r = {
      clamp_to(-dot3(t, asked) - dot3(n, second),
               smaller(most_bend, larger(held * most_bend, K(2) * lean))),
      clamp_to(dot3(m, sub3(asked, own)) / larger(dot3(m, cross3(n, unit3(t))), splat(TINY)),
               smaller(most_twist, larger(held * FAIR_MOST_TWIST, K(0.5f) * norm3(own))))};
  return r;
}

// The `turn` of a side between two quads, for whose normals there is no more than degree 2: that of
// the shape operators of its ends at mid-side.
FN real3 mid_normal_of(fair_curve c, shape_operator s0, shape_operator s1) {
  const real3 e = unit3(c.edge), sum = add3(c.n0, c.n1);
  const real lean = lean_of(c, e), most_twist = splat(FAIR_MOST_TWIST);
  const real a = fair_change_of(c, s0, 0, e, lean, most_twist).twist,
             b = fair_change_of(c, s1, 1, e, lean, most_twist).twist;
  return mul3(K(0.5f) * clamp_to(a - b, splat(K(4) * FAIR_MOST_SMOOTH_TURN)),
              unit3(cross3(sum, e)));
}

// f a + g b
FN real3 sum_of(scalar f, scalar g, real3 a, real3 b) {
  return fma3(splat(f), a, mul3(splat(g), b));
}

// The side with the shape operators of its ends, or without: its normal is then
// (1 - t) n_0 + t n_1 + t (1 - t) turn.
FN void fair_side(fair_curve c, shape_operator s0, shape_operator s1, mask shaped, real twist_share,
                  real3 turn, control_out out) {
  const real3 rise = sub3(c.n1, c.n0), e = unit3(c.edge);
  const real none = splat(K(0)), lean = lean_of(c, e), most_twist = FAIR_MOST_TWIST * twist_share;
  fair_change a = fair_change_of(c, s0, 0, e, lean, most_twist),
              b = fair_change_of(c, s1, 1, e, lean, most_twist);
  a.bend = pick(shaped, a.bend, none);
  a.twist = pick(shaped, a.twist, none);
  b.bend = pick(shaped, b.bend, none);
  b.twist = pick(shaped, b.twist, none);
  // C + (a / 2) n_0 t^2 (1-t)^3 + (b / 2) n_1 t^3 (1-t)^2
  const real3 p = mul3(K(0.5f) * a.bend, c.n0), q = mul3(K(0.5f) * b.bend, c.n1);
  real3 curve[6] = {c.p0,    c.t0,   cubic_2(c.edge, c.t0, c.t1), cubic_3(c.edge, c.t0, c.t1),
                    zero3(), zero3()};
  curve[2] = add3(curve[2], p);
  curve[3] = add3(curve[3], sum_of(K(-3), K(1), p, q));
  curve[4] = sum_of(K(3), K(-2), p, q);
  curve[5] = sum_of(K(-1), K(1), p, q);
  // n + x t (1-t)^2 - y t^2 (1-t)
  const real3 x = mul3(a.twist, cross3(c.n0, unit3(c.t0))),
              y = mul3(b.twist, cross3(c.n1, unit3(c.t1)));
  const real3 normal[4] = {c.n0, add3(add3(rise, turn), x), sub3(sum_of(K(-2), K(-1), x, y), turn),
                           add3(x, y)};
  for (int i = 0; i < 6; ++i) put3(out, FAIR_CURVE + i, curve[i]);
  for (int i = 0; i < 4; ++i) put3(out, FAIR_NORMAL + i, normal[i]);
  out[FAIR_SOUND] = c.sound;
}

// Bezier point `i` of degree `degree` of the polynomial of `count` triples in powers of t.
FN real3 bezier_point(const real3* power, int count, int degree, int i) {
  real3 sum = power[0];
  scalar f = K(1);  // binomial(i, j) / binomial(degree, j)
  for (int j = 1; j < count && j <= i; ++j) {
    f *= K(i - j + 1) / K(degree - j + 1);
    sum = fma3(splat(f), power[j], sum);
  }
  return sum;
}

// A side's C, C', T and, but for flat ones, m in powers of t.
typedef struct {
  real3 curve[6], slope[5], t[6], m[4];
  real inward_share;  // the least share of T that points into the face, at the ends: never below 0
                      // unless the patch doubles back along the side
} fair_tangent;

// The cross tangent T = k C' + h m of a side, m = n x e: k and h are linear between the values that
// `start` and `end`, T(0) and T(1), ask for (step 5 of docs/method.md). `flat`: a unit normal that
// T shall lie across, for patches that give up their neighbours' normals: T goes straight from one
// end to the other, `length` times as long. Else null.
FN fair_tangent fair_tangent_of(control_data side, real3 start, real3 end, GLOBAL scalar* flat,
                                scalar length) {
  fair_tangent r;
  for (int i = 0; i < 6; ++i) r.curve[i] = load3(side, FAIR_CURVE + i);
  for (int i = 0; i < 5; ++i) r.slope[i] = mul3(splat(K(i + 1)), r.curve[i + 1]);
  real3 edge = r.curve[1], last = r.slope[0];  // C(1) - C(0), C'(1)
  for (int i = 2; i < 6; ++i) edge = add3(edge, r.curve[i]);
  for (int i = 1; i < 5; ++i) last = add3(last, r.slope[i]);
  if (flat) {
    const real3 n = load3(flat, 0);
    const real3 a = mul3(splat(length), fma3(-dot3(start, n), n, start)),
                b = mul3(splat(length), fma3(-dot3(end, n), n, end));
    for (int i = 0; i < 6; ++i) r.t[i] = i == 0 ? a : mul3(splat(i == 1 ? K(1) : K(0)), sub3(b, a));
    r.inward_share = splat(K(1));
    return r;
  }
  const real3 e = unit3(edge);
  real3 m1 = zero3();
  for (int i = 0; i < 4; ++i) {
    r.m[i] = cross3(load3(side, FAIR_NORMAL + i), e);
    m1 = add3(m1, r.m[i]);
  }
  const ribbon_coefficients a = ribbon_coefficients_of(start, r.curve[1], r.m[0]),
                            b = ribbon_coefficients_of(end, last, m1);
  const real dk = b.k - a.k, dh = b.h - a.h;
  for (int i = 0; i < 6; ++i) r.t[i] = zero3();
  for (int i = 0; i < 5; ++i) {
    r.t[i] = fma3(a.k, r.slope[i], r.t[i]);
    r.t[i + 1] = mul3(dk, r.slope[i]);
  }
  for (int i = 0; i < 4; ++i) {
    r.t[i] = fma3(a.h, r.m[i], r.t[i]);
    r.t[i + 1] = fma3(dh, r.m[i], r.t[i + 1]);
  }
  r.inward_share =
      smaller(a.h / larger(norm3(start), splat(TINY)), b.h / larger(norm3(end), splat(TINY)));
  return r;
}

// The same of side k of n [n][FAIR_REALS].
FN fair_tangent fair_tangent_at(control_data sides, int n, int k, GLOBAL scalar* flat,
                                scalar length) {
  const control_data before = sides + wrap(k - 1, n) * FAIR_REALS,
                     after = sides + wrap(k + 1, n) * FAIR_REALS;
  real3 back = load3(before, FAIR_CURVE + 1);
  for (int i = 2; i < 6; ++i) back = fma3(splat(K(i)), load3(before, FAIR_CURVE + i), back);
  return fair_tangent_of(sides + k * FAIR_REALS, mul3(splat(K(-1)), back),
                         load3(after, FAIR_CURVE + 1), flat, length);
}

// A polynomial of `count` triples.
FN real3 power_sum(const real3* power, int count, real t) {
  real3 sum = power[count - 1];
  for (int i = count - 2; i >= 0; --i) sum = fma3(t, sum, power[i]);
  return sum;
}

// A point amid a face. For a quadratic surface f over its plane and any weights that add up to 1,
//   f(m) = sum w_k (f(p_k) + grad f(p_k) . (m - p_k) / 2),  m = sum w_k p_k,
// so the point lies on any such surface with the face's corners and normals. w_k is the length of
// both sides at a corner.
FN real3 fair_middle(control_data sides, int n) {
  real3 middle = zero3(), across = zero3();
  real total = splat(K(0));
  for (int k = 0; k < n; ++k) {
    const real3 p = load3(sides + k * FAIR_REALS, FAIR_CURVE),
                q = load3(sides + wrap(k + 1, n) * FAIR_REALS, FAIR_CURVE);
    const real length = norm3(sub3(q, p));
    middle = fma3(length, add3(p, q), middle);
    total += K(2) * length;
  }
  middle = mul3(K(1) / total, middle);
  for (int k = 0; k < n; ++k) {
    const real3 p = load3(sides + k * FAIR_REALS, FAIR_CURVE),
                q = load3(sides + wrap(k + 1, n) * FAIR_REALS, FAIR_CURVE);
    across = add3(across, cross3(sub3(p, middle), sub3(q, middle)));
  }
  across = unit3(across);
  real height = splat(K(0));
  for (int k = 0; k < n; ++k) {
    const control_data side = sides + k * FAIR_REALS, before = sides + wrap(k - 1, n) * FAIR_REALS,
                       after = sides + wrap(k + 1, n) * FAIR_REALS;
    const real3 p = load3(side, FAIR_CURVE), normal = load3(side, FAIR_NORMAL);
    const real weight =
        norm3(sub3(load3(before, FAIR_CURVE), p)) + norm3(sub3(load3(after, FAIR_CURVE), p));
    // Tangent planes that are steeper than FAIR_STEEP tell nothing of the middle.
    height =
        fma(weight, dot3(normal, sub3(p, middle)) / larger(dot3(normal, across), splat(FAIR_STEEP)),
            height);
  }
  return fma3(K(0.5f) * height / total, across, middle);
}

// Control data of the patch between five sides and more, whose curves are cubic and whose normals
// linear, in FORM_CURVED. `apothem`: that of the domain. Returns fair_tangent::inward_share of the
// worst.
//
// On a regular polygon in a plane a ribbon with linear k and h is the plane itself: the lines of
// constant u_k meet where the sides beyond do, and d_k / unit goes from 0 to 1 along these. So T is
// that over `unit`, and Q takes the ribbon's ends to the corners beyond. At u = 1/2 a ribbon shall
// meet the middle of the face: T goes there, within the tangent plane, and Q takes what is left.
FN_LARGE real fair_polygon(control_data sides, int n, scalar apothem, control_out out) {
  const scalar unit = K(4) * apothem * (K(1) - apothem * apothem), over = K(1) / unit;
  const scalar way = apothem * over;
  const real one = splat(K(1)), minus = splat(K(-1)), four = splat(K(4)), half = splat(K(0.5f));
  const real3 middle = fair_middle(sides, n);
  real inward_share = one;
  for (int k = 0; k < n; ++k) {
    fair_tangent f = fair_tangent_at(sides, n, k, 0, K(1));
    const real3 start = f.t[0], end = power_sum(f.t, 6, one);
    const real3 slope = power_sum(f.slope, 5, half), m = power_sum(f.m, 4, half),
                away = sub3(middle, power_sum(f.curve, 6, half));
    const ribbon_coefficients straight = ribbon_coefficients_of(power_sum(f.t, 6, half), slope, m),
                              wanted =
                                  ribbon_coefficients_of(mul3(splat(K(1) / way), away), slope, m);
    // 4 t (1 - t) of the difference, which keeps h above 0.
    const real dk = K(4) * (wanted.k - straight.k),
               dh = K(4) * (larger(wanted.h, half * straight.h) - straight.h);
    for (int i = 0; i < 3; ++i) {
      const real3 more = fma3(dk, f.slope[i], mul3(dh, f.m[i]));
      f.t[i + 1] = add3(f.t[i + 1], more);
      f.t[i + 2] = sub3(f.t[i + 2], more);
    }
    const real3 p = f.curve[0], q = load3(sides + wrap(k + 1, n) * FAIR_REALS, FAIR_CURVE),
                before = load3(sides + wrap(k - 1, n) * FAIR_REALS, FAIR_CURVE),
                after = load3(sides + wrap(k + 2, n) * FAIR_REALS, FAIR_CURVE);
    const real3 q0 = sub3(sub3(before, p), start), q2 = sub3(sub3(after, q), end),
                q1 = mul3(splat(K(1) / (way * way)),
                          fma3(splat(-way), power_sum(f.t, 6, half), away));
    const real3 bend[3] = {q0, fma3(four, q1, fma3(splat(K(-3)), q0, mul3(minus, q2))),
                           fma3(-four, q1, mul3(splat(K(2)), add3(q0, q2)))};
    const control_out to = out + k * CURVED_REALS;
    for (int i = 0; i < 4; ++i) put3(to, CURVED_C + i, i == 3 ? q : bezier_point(f.curve, 4, 3, i));
    for (int i = 0; i < 5; ++i) put3(to, CURVED_T + i, mul3(splat(over), f.t[i]));
    for (int i = 0; i < 3; ++i) put3(to, CURVED_Q + i, mul3(splat(over * over), bend[i]));
    inward_share = smaller(f.inward_share, inward_share);
  }
  return inward_share;
}

// Control data of the quad between four sides, whose curves are cubic and whose normals quadratic,
// in FORM_BEZIER; `flat` and `length` as above. Returns fair_tangent::inward_share of the worst.
FN_LARGE real fair_quad(control_data sides, GLOBAL scalar* flat, scalar length, control_out out) {
  bezier_side s[4];
  real inward_share = splat(K(1));
  for (int k = 0; k < 4; ++k) {
    const fair_tangent f = fair_tangent_at(sides, 4, k, flat, length);
    for (int i = 0; i < 4; ++i) {
      s[k].c[i] = f.curve[i];
      s[k].t[i] = f.t[i];
    }
    to_bezier(s[k].c);
    to_bezier(s[k].t);
    inward_share = smaller(f.inward_share, inward_share);
  }
  store_quad(s, out);
  return inward_share;
}

// A side's control points: of the boundary, raised to degree 6, and of the row within.
typedef struct {
  real3 rim[6], inner[6];
} sextic_side;

FN sextic_side sextic_side_of(fair_tangent f) {
  // T + t C', the derivative towards the corner that is not on the side.
  for (int i = 1; i < 6; ++i) f.t[i] = add3(f.t[i], f.slope[i - 1]);
  sextic_side r;
  for (int i = 0; i < 6; ++i) {
    r.rim[i] = bezier_point(f.curve, 6, 6, i);
    r.inner[i] = fma3(splat(K(1) / K(6)), bezier_point(f.t, 6, 5, i), r.rim[i]);
  }
  return r;
}

// The point of powers i, j, k of the coordinates of side's start, its end, the corner beyond.
FN int sextic_point_of(int side, int i, int j, int k) {
  const int power[3] = {side == 0   ? i
                        : side == 1 ? k
                                    : j,
                        side == 0   ? j
                        : side == 1 ? i
                                    : k,
                        side == 0   ? k
                        : side == 1 ? j
                                    : i};
  return sextic_point(power[1], power[2]);
}

// Control data of the triangle between three sides; `flat` and `length` as above. Returns
// fair_tangent::inward_share of the worst.
FN_LARGE real fair_triangle(control_data sides, GLOBAL scalar* flat, scalar length,
                            control_out out) {
  sextic_side s[3];
  real inward_share = splat(K(1));
  for (int k = 0; k < 3; ++k) {
    const fair_tangent f = fair_tangent_at(sides, 3, k, flat, length);
    s[k] = sextic_side_of(f);
    inward_share = smaller(f.inward_share, inward_share);
  }
  const real half = splat(K(0.5f));
  real3 near = zero3(), far = near;  // sums of the points 411 and of the points 321
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 6; ++i) put3(out, sextic_point_of(k, 6 - i, i, 0), s[k].rim[i]);
    const real3 a = s[k].inner[1], b = s[wrap(k - 1, 3)].inner[4];
    const real3 mean = mul3(half, add3(a, b));
    put3(out, sextic_point_of(k, 4, 1, 1), mean);
    put3(out, SEXTIC_DIFFERENCE + k, mul3(splat(K(15)), sub3(a, b)));
    put3(out, sextic_point_of(k, 3, 2, 1), s[k].inner[2]);
    put3(out, sextic_point_of(k, 2, 3, 1), s[k].inner[3]);
    near = add3(near, mean);
    far = add3(far, add3(s[k].inner[2], s[k].inner[3]));
  }
  // The middle goes on as the points before it do: m6 + (m6 - m3) / 2.
  put3(out, sextic_point_of(0, 2, 2, 2),
       fma3(splat(K(0.25f)), far, mul3(splat(K(-1) / K(6)), near)));
  return inward_share;
}
