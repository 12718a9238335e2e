// A side whose cross tangent is a polynomial, T = k C' + h m: with m(t) = ((1-t) n_s + t n_e) x e
// the normal C' x T is that of eq. 10 for any polynomials k and h, whoever chose them on the other
// side of the edge (Chiyokura and Kimura 1983). Here both are quartic and give T and T' of the
// paper at the ends and T at mid-side.

// After what side.h says: T is the cubic of its ends plus t^2 (1-t)^2 (q_0 + t q_1 + t^2 q_2).
#define RIBBON_REST 8  // q_0, q_1, q_2: 3 triples
#define RIBBON_REALS 33

// Cubic Hermite basis on [0, 1] with derivatives: values h, slopes g at 0 and 1. The second ones
// are halved.
typedef struct {
  real h0, h1, g0, g1, dh0, dh1, dg0, dg1, hh1, hg0, hg1;
} hermite_basis;

FN hermite_basis hermite_at(real t) {
  const real s = K(1) - t, st = s * t;
  hermite_basis r;
  r.h1 = t * t * fma(splat(K(-2)), t, splat(K(3)));
  r.h0 = K(1) - r.h1;
  r.g0 = s * st;
  r.g1 = -t * st;
  r.dh1 = K(6) * st;
  r.dh0 = -r.dh1;
  r.dg0 = s * fma(splat(K(-3)), t, splat(K(1)));
  r.dg1 = t * fma(splat(K(3)), t, splat(K(-2)));
  r.hh1 = K(3) * (s - t);
  r.hg0 = fma(splat(K(3)), t, splat(K(-2)));
  r.hg1 = fma(splat(K(3)), t, splat(K(-1)));
  return r;
}

FN curve_jet ribbon_tangent(control_data side, real t) {
  const hermite_basis ends = hermite_at(t);
  const real s = K(1) - t, st = s * t;
  const real w = st * st, dw = K(2) * st * (s - t), hw = fma(splat(K(-6)), st, splat(K(1)));
  const real3 start = load3(side, SIDE_T_0), d = sub3(load3(side, SIDE_T_1), start);
  const real3 a = load3(side, SIDE_TWIST_0), b = load3(side, SIDE_TWIST_1);
  const real3 q1 = load3(side, RIBBON_REST + 1), q2 = load3(side, RIBBON_REST + 2);
  const real3 q = fma3(t, fma3(t, q2, q1), load3(side, RIBBON_REST)), dq = fma3(K(2) * t, q2, q1);
  curve_jet r;
  r.f = fma3(w, q, fma3(ends.g1, b, fma3(ends.g0, a, fma3(ends.h1, d, start))));
  r.d = fma3(w, dq, fma3(dw, q, fma3(ends.dg1, b, fma3(ends.dg0, a, mul3(ends.dh1, d)))));
  r.h = fma3(w, q2,
             fma3(dw, dq, fma3(hw, q, fma3(ends.hg1, b, fma3(ends.hg0, a, mul3(ends.hh1, d))))));
  return r;
}

FN side_point ribbon_at(control_data side, real t) {
  const curve_point c = cubic_at(side, SIDE_C, t);
  const curve_jet tangent = ribbon_tangent(side, t);
  const side_point r = {c.f, c.d, tangent.f, tangent.d};
  return r;
}
