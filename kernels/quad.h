// Patches of four sides, of the forms that blend sides. Opposite distances add up to a constant
// there, so that the parameters of eq. 3 are linear, v_k = u_(k+1) = 1 - u_(k-1), and the weights
// of eq. 5 separate:
//   w_k = A(u_k) A(v_k),  A(x) = (1-x)^2 / (x^2 + (1-x)^2).
// What eq. 4 sums over the two corners of a side is then A(v) (C(u) + v T(u)).

// The part that eq. 2 subtracts at a corner, V + v T(0) + u T_before(1) + twist, with its
// derivatives along u and v. The twist as in add_twist.
FN patch_point corner_excess(control_data side, control_data before, real u, real v) {
  const real one = splat(K(1)), inverse = one / larger(u + v, splat(TINY));
  const real r = u * inverse, s = v * inverse, uv = u * v;
  const real3 p = load3(before, SIDE_T_1), q = load3(side, SIDE_T_0);
  const real3 a = load3(side, SIDE_TWIST_0), b = load3(before, SIDE_TWIST_1);
  patch_point e;
  e.g = fma3(-uv * r, b, fma3(uv * s, a, fma3(u, p, fma3(v, q, load3(side, SIDE_C)))));
  e.g_xi = fma3(-v * fma(-s, s, one), b, fma3(v * s * s, a, p));
  e.g_eta = fma3(-u * r * r, b, fma3(u * fma(-r, r, one), a, q));
  return e;
}

FN patch_point evaluate_quad(control_data control, uint form, real xi, real eta) {
  const int reals = side_reals(form);
  const real one = splat(K(1)), one_half = splat(K(0.5f)), zero = splat(K(0));
  const real u[4] = {
      one_half * larger(one - xi + eta, zero), one_half * larger(one - xi - eta, zero),
      one_half * larger(one + xi - eta, zero), one_half * larger(one + xi + eta, zero)};
  real a[4], slope[2];  // A(u_k); A', the same of opposite corners
  UNROLL
  for (int k = 0; k < 2; ++k) {
    const real x = u[k], y = u[k + 2], inverse = one / fma(x, x, y * y);
    a[k] = y * y * inverse;
    a[k + 2] = x * x * inverse;
    slope[k] = K(-2) * (x * inverse) * (y * inverse);
  }
  patch_point sum = {zero3(), zero3(), zero3()};
  UNROLL
  for (int k = 0; k < 4; ++k) {  // derivatives of the sum along u_k and v_k
    const int next = (k + 1) & 3;
    control_data side = control + k * reals;
    control_data before = control + ((k + 3) & 3) * reals;
    const side_point at =
        form == FORM_RIBBON ? ribbon_at(side, u[k]) : side_at(side, u[k], u[(k + 2) & 3]);
    const real av = a[next], dv = slope[next & 1], w = a[k] * av;
    const real3 across = fma3(u[next], at.t, at.c);
    const patch_point e = corner_excess(side, before, u[k], u[next]);
    const real3 g = fma3(-w, e.g, fma3(av, across, sum.g));
    const real3 g_u = fma3(-slope[k & 1] * av, e.g,
                           fma3(-w, e.g_xi, fma3(av, fma3(u[next], at.dt, at.dc), sum.g_xi)));
    const real3 g_v =
        fma3(-a[k] * dv, e.g, fma3(-w, e.g_eta, fma3(av, at.t, fma3(dv, across, sum.g_eta))));
    // The next corner's u is this one's v, its v is 1 - u.
    sum.g = g;
    sum.g_xi = g_v;
    sum.g_eta = mul3(splat(K(-1)), g_u);
  }
  patch_point r;
  r.g = sum.g;
  r.g_xi = mul3(-one_half, add3(sum.g_xi, sum.g_eta));
  r.g_eta = mul3(one_half, sub3(sum.g_xi, sum.g_eta));
  return r;
}
