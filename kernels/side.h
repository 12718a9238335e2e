// One side of a patch: its boundary curve C and cross tangent T (eq. 6 to 14), from control data
// made by build.h.

typedef struct {
  real3 c, dc;  // C(t), C'(t)
  real3 t, dt;  // T(t), T'(t), towards the interior
} side_point;

typedef struct {
  real3 f, d;  // value and derivative
} curve_point;

// A vector that depends on t, with its first and half its second derivative.
typedef struct {
  real3 f, d, h;
} curve_jet;

// The rise since t = 0, over t, of the cubic of the four triples from `first`.
FN real3 cubic_rise(control_data side, int first, real t) {
  return fma3(t, fma3(t, load3(side, first + 3), load3(side, first + 2)), load3(side, first + 1));
}
FN curve_point cubic_at(control_data side, int first, real t) {
  const real3 c1 = load3(side, first + 1), c2 = load3(side, first + 2), c3 = load3(side, first + 3);
  curve_point r;
  r.f = fma3(t, cubic_rise(side, first, t), load3(side, first));
  r.d = fma3(t, fma3(K(3) * t, c3, mul3(splat(K(2)), c2)), c1);
  return r;
}

// Surface normal along the side, not of unit length (eq. 10).
FN real3 side_normal(control_data side, real t) { return cubic_at(side, SIDE_NORMAL, t).f; }

// The cubic a + b t + c t^2 + d t^3 (Horner).
FN curve_jet cubic_jet(real3 a, real3 b, real3 c, real3 d, real t) {
  curve_jet r;
  r.f = fma3(t, d, c);
  r.d = fma3(t, d, r.f);
  r.h = fma3(t, d, r.d);
  r.f = fma3(t, r.f, b);
  r.d = fma3(t, r.d, r.f);
  r.f = fma3(t, r.f, a);
  return r;
}

// The cross tangent T of eq. 14: eq. 11 and 13 with a unit n_c, times a positive factor:
//   t_c = N x (v x b),  b = |N| a + N,  a = (1-t) n_(s-) + t n_(e+),  v = v_int,
//   v = (1-t) (v_(s-) - v_s) + t (v_(e+) - v_e) + t (1-t) (c_2 + (1+t) c_3):
// differences of positions, for v may be small beside them. `rest` is 1 - t, to its own precision.
FN curve_jet cross_tangent(control_data side, real t, real rest) {
  const real two = splat(K(2)), tiny = splat(TINY);
  const curve_point n = cubic_at(side, SIDE_NORMAL, t);
  const real3 ddn =
      mul3(two, fma3(K(3) * t, load3(side, SIDE_NORMAL + 3), load3(side, SIDE_NORMAL + 2)));
  const real3 da = load3(side, SIDE_INNER + 1);
  const real3 a = fma3(t, da, load3(side, SIDE_INNER));
  const real3 before = load3(side, SIDE_ACROSS), after = load3(side, SIDE_ACROSS + 1);
  const real3 c3 = load3(side, SIDE_C + 3), q = fma3(splat(K(1)) + t, c3, load3(side, SIDE_C + 2));
  const real3 v = fma3(t * rest, q, fma3(t, after, mul3(rest, before)));
  const real3 dv = fma3(t * rest, c3, fma3(rest - t, q, sub3(after, before)));
  const real3 ddv = mul3(two, fma3(rest - t, c3, mul3(splat(K(-1)), q)));
  const real l = larger(norm3(n.f), tiny), dl = dot3(n.f, n.d) / l;
  const real ddl = (dot3(n.d, n.d) + dot3(n.f, ddn) - dl * dl) / l;
  const real3 b = fma3(l, a, n.f), db = fma3(l, da, fma3(dl, a, n.d)),
              ddb = fma3(two * dl, da, fma3(ddl, a, ddn));
  const real3 vb = cross3(v, b), dvb = cross_add3(dv, b, cross3(v, db)),
              ddvb = cross_add3(ddv, b, cross_add3(mul3(two, dv), db, cross3(v, ddb)));
  const real3 tc = cross3(n.f, vb), dtc = cross_add3(n.d, vb, cross3(n.f, dvb)),
              ddtc = cross_add3(ddn, vb, cross_add3(mul3(two, n.d), dvb, cross3(n.f, ddvb)));
  const real inverse = K(1) / larger(norm3(tc), tiny);
  // unit' = (t_c' - unit |t_c|') / |t_c|,  unit'' = (t_c'' - unit |t_c|'' - 2 unit' |t_c|') / |t_c|
  const real3 unit = mul3(inverse, tc);
  const real grows = dot3(unit, dtc);
  const real3 turn = fma3(-grows, unit, dtc), dunit = mul3(inverse, turn);
  const real ddnorm = dot3(dunit, dtc) + dot3(unit, ddtc);
  const real3 ddturn = fma3(-ddnorm, unit, fma3(-two * grows, dunit, ddtc));
  const real l0 = number_at(side, SIDE_LENGTH), l1 = number_at(side, SIDE_LENGTH + 1);
  const real ease = K(4) * number_at(side, SIDE_EASE);
  const real shorter = fma(-ease, t * rest, splat(K(1)));
  const real dshorter = ease * fma(two, t, splat(K(-1)));
  const real straight = fma(t, l1, rest * l0);
  const real length = straight * shorter;
  const real dlength = fma(straight, dshorter, (l1 - l0) * shorter);
  const real half_ddlength = fma(straight, ease, (l1 - l0) * dshorter);
  curve_jet r;
  r.f = mul3(length, unit);
  r.d = fma3(dlength, unit, mul3(length * inverse, turn));
  r.h = fma3(half_ddlength, unit, fma3(dlength, dunit, mul3(K(0.5f) * length * inverse, ddturn)));
  return r;
}

FN side_point side_at(control_data side, real t, real rest) {
  const curve_point c = cubic_at(side, SIDE_C, t);
  const curve_jet tangent = cross_tangent(side, t, rest);
  const side_point r = {c.f, c.d, tangent.f, tangent.d};
  return r;
}
