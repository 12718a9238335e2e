// The Gregory patch of an n-sided polygon: a blend of its corner interpolators (eq. 2 and 4), with
// first derivatives.

typedef struct {
  real3 g, g_xi, g_eta;
} patch_point;

// Numbers of a side, of the forms that blend sides.
FN int side_reals(uint form) { return form == FORM_RIBBON ? RIBBON_REALS : SIDE_REALS; }

// G and its derivatives from sums of jets: G += f x with x constant (a point or a tangent of the
// corner).
FN patch_point add_constant(patch_point p, jet f, real3 x) {
  p.g = fma3(f.f, x, p.g);
  p.g_xi = fma3(f.xi, x, p.g_xi);
  p.g_eta = fma3(f.eta, x, p.g_eta);
  return p;
}
// ... and with x moving along a side: x = x(u).
FN patch_point add_moving(patch_point p, jet f, jet u, real3 x, real3 dx) {
  p = add_constant(p, f, x);
  p.g_xi = fma3(f.f * u.xi, dx, p.g_xi);
  p.g_eta = fma3(f.f * u.eta, dx, p.g_eta);
  return p;
}

// The compatibly corrected twist of eq. 2, times the weight w, in a form that stands at u + v = 0:
//   w uv (v A + u B) / (u + v),  A = T_P'(0), B = T_Q'(0).
FN patch_point add_twist(patch_point p, jet w, jet u, jet v, real3 a, real3 b) {
  const real inverse = K(1) / larger(u.f + v.f, splat(TINY));
  const real r = u.f * inverse, s = v.f * inverse, uv = u.f * v.f;
  const real one = splat(K(1));
  // f = fa A + fb B; along u: v (s^2 A + (1 - s^2) B); along v: u ((1 - r^2) A + r^2 B)
  const real ua = v.f * s * s, ub = v.f * fma(-s, s, one);
  const real va = u.f * fma(-r, r, one), vb = u.f * r * r;
  const jet fa = make_jet(uv * s, fma(ua, u.xi, va * v.xi), fma(ua, u.eta, va * v.eta));
  const jet fb = make_jet(uv * r, fma(ub, u.xi, vb * v.xi), fma(ub, u.eta, vb * v.eta));
  return add_constant(add_constant(p, mul_jet(w, fa), a), mul_jet(w, fb), b);
}

// G(xi, eta) in the patch's local frame. The corners k and k+1 use side k at the same parameter
// u_k, so that
//   G = sum_k (w_k + w_(k+1)) C_k(u_k) + (w_k v_k + w_(k+1) u_(k+1)) T_k(u_k)
//     - sum_k w_k (V_k + v_k T_k(0) + u_k T_(k-1)(1) + twist_k):  n side evaluations a point, not
//     2n.
// Weights change by n^2 over the domain, and so do roundings of what they multiply: with many sides
// all positions are measured from a corner of the nearest one, which leaves n of them.
FN patch_point evaluate(GLOBAL scalar* domain, control_data control, uint form, int n, real xi,
                        real eta) {
  const int reals = side_reals(form);
  const real3 zero = zero3();
  patch_point sum = {zero, zero, zero};
  jet total = make_jet(zero.x, zero.x, zero.x);
  const near_sides near = find_near_sides(domain, n, xi, eta);
  const int many = n >= DOMAIN_COMPENSATED;
  const real3 from = many ? gather3(control, near.s * splat((scalar)reals)) : zero;
  jet v = corner_u(domain, n, n - 1, xi, eta).rest;
  corner_parameter here = corner_u(domain, n, 0, xi, eta);
  jet w = corner_weight(domain, n, 0, near, xi, eta);
  UNROLL
  for (int k = 0; k < n; ++k) {
    const int after = wrap(k + 1, n);
    control_data side = control + k * reals;
    control_data before = control + wrap(k - 1, n) * reals;
    const jet u = here.u;
    const corner_parameter next = corner_u(domain, n, after, xi, eta);
    const jet w_next = corner_weight(domain, n, after, near, xi, eta);
    side_point at = form == FORM_RIBBON ? ribbon_at(side, u.f) : side_at(side, u.f, here.rest.f);
    real3 corner = load3(side, SIDE_C);
    if (many) {
      corner = sub3(corner, from);
      at.c = fma3(u.f, cubic_rise(side, SIDE_C, u.f), corner);
    }
    const jet on_curve = add_jet(w, w_next);
    const jet on_tangent = add_jet(mul_jet(w, v), mul_jet(w_next, next.u));
    sum = add_moving(sum, on_curve, u, at.c, at.dc);
    sum = add_moving(sum, on_tangent, u, at.t, at.dt);
    const jet minus = make_jet(-w.f, -w.xi, -w.eta);
    sum = add_constant(sum, minus, corner);
    sum = add_constant(sum, mul_jet(minus, v), load3(side, SIDE_T_0));
    sum = add_constant(sum, mul_jet(minus, u), load3(before, SIDE_T_1));
    // T_Q runs against side k-1, hence the sign of its derivative.
    const real3 b = mul3(splat(K(-1)), load3(before, SIDE_TWIST_1));
    sum = add_twist(sum, minus, u, v, load3(side, SIDE_TWIST_0), b);
    total = add_jet(total, w);
    v = here.rest;
    here = next;
    w = w_next;
  }
  const real inverse = K(1) / total.f;
  patch_point r;
  r.g = mul3(inverse, sum.g);
  r.g_xi = mul3(inverse, fma3(-total.xi, r.g, sum.g_xi));
  r.g_eta = mul3(inverse, fma3(-total.eta, r.g, sum.g_eta));
  if (many) r.g = add3(r.g, from);
  return r;
}

FN real3 patch_normal(patch_point p) { return cross3(p.g_xi, p.g_eta); }

// As nine rows of `stride` numbers: G, G_xi, G_eta.
FN void store_point(GLOBAL_OUT scalar* out, ulong stride, patch_point p) {
  store3(out, stride, p.g);
  store3(out + 3 * stride, stride, p.g_xi);
  store3(out + 6 * stride, stride, p.g_eta);
}
