// The patch of five sides and more of the fair construction: a blend of curved ribbons, one a side,
//   R_k = C_k(u_k) + d_k (T_k(u_k) + d_k Q_k(u_k)),
// with u_k of eq. 3, the distance d_k to the side, and weights ~ 1 / d_k^2. Where u_k is constant
// R_k is a parabola that leaves the side along T_k. On its side a patch has R_k alone, with its
// first derivatives, so that its normals are those of C' x T. Control data come from fair.h.
//   Kato 1991; Salvi, Varady, Rockwood 2014: patches from the ribbons of their sides.

// Control data of a side, local frame.
#define CURVED_C 0  // boundary curve: 4 Bezier points
#define CURVED_T 4  // cross tangent, quartic, in powers of t: 5 triples
#define CURVED_Q 9  // quadratic, in powers of t: 3 triples
#define CURVED_REALS 36

// R and its derivatives along u and d, measured from a point: roundings are in proportion to how
// far from it R is.
typedef struct {
  real3 r, along, across;
} curved_ribbon;

// `rest` is 1 - u, to its own precision.
FN curved_ribbon ribbon_from(control_data side, real3 from, real u, real rest, real d) {
  const real3 p0 = sub3(load3(side, CURVED_C), from), p1 = sub3(load3(side, CURVED_C + 1), from),
              p2 = sub3(load3(side, CURVED_C + 2), from),
              p3 = sub3(load3(side, CURVED_C + 3), from);
  const real three = splat(K(3)), uu = u * u, ur = u * rest, rr = rest * rest;
  const real3 c =
      fma3(rr * rest, p0, fma3(three * rr * u, p1, fma3(three * uu * rest, p2, mul3(uu * u, p3))));
  const real3 dc = fma3(rr, sub3(p1, p0), fma3(K(2) * ur, sub3(p2, p1), mul3(uu, sub3(p3, p2))));
  const curve_point t = polynomial(side, CURVED_T, 5, u), q = polynomial(side, CURVED_Q, 3, u);
  const real3 slope = fma3(d, q.f, t.f);
  curved_ribbon r;
  r.r = fma3(d, slope, c);
  r.along = fma3(d, fma3(d, q.d, t.d), mul3(three, dc));
  r.across = fma3(d, q.f, slope);
  return r;
}

// Weights change fast near a corner, where ribbons differ by little: all is measured from the
// corner of the two nearest sides.
FN patch_point curved_patch(GLOBAL scalar* domain, control_data control, int n, real xi, real eta) {
  const real zero = splat(K(0)), one = splat(K(1));
  const near_sides near = find_near_sides(domain, n, xi, eta);
  const real next = pick(near.s < splat((scalar)(n - 1)), near.s + one, zero);
  const real corner = pick(near.t == next, near.t, near.s);
  const real3 from = gather3(control, corner * splat(K(CURVED_REALS)));
  const real3 none = zero3();
  patch_point sum = {none, none, none};
  jet total = make_jet(zero, zero, zero);
  UNROLL
  for (int k = 0; k < n; ++k) {
    const corner_parameter at = corner_u(domain, n, k, xi, eta);
    const jet u = at.u, d = side_distance(domain, n, k, xi, eta);
    // d_s / d_k for the nearest side s, squared.
    const mask is_near = near.s == splat((scalar)k);
    const real inverse = one / larger(d.f, splat(TINY));
    const real rho = pick(is_near, one, near.d_s.f * inverse);
    const real twice = pick(is_near, zero, K(2) * rho * inverse);
    const jet w = make_jet(rho * rho, twice * fma(-rho, d.xi, near.d_s.xi),
                           twice * fma(-rho, d.eta, near.d_s.eta));
    const curved_ribbon r = ribbon_from(control + k * CURVED_REALS, from, u.f, at.rest.f, d.f);
    sum = add_constant(sum, w, r.r);
    sum.g_xi = fma3(w.f, fma3(u.xi, r.along, mul3(d.xi, r.across)), sum.g_xi);
    sum.g_eta = fma3(w.f, fma3(u.eta, r.along, mul3(d.eta, r.across)), sum.g_eta);
    total = add_jet(total, w);
  }
  const real inverse = one / total.f;
  patch_point p;
  p.g = mul3(inverse, sum.g);
  p.g_xi = mul3(inverse, fma3(-total.xi, p.g, sum.g_xi));
  p.g_eta = mul3(inverse, fma3(-total.eta, p.g, sum.g_eta));
  p.g = add3(p.g, from);
  return p;
}
