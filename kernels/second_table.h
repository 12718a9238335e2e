// Fills the tables of second.h. On the host only, in scalars.

FN jet2 linear_jet2(real f, real xi, real eta) {
  const real zero = splat(K(0));
  const jet2 r = {f, xi, eta, zero, zero, zero};
  return r;
}
FN jet2 mul_jet2(jet2 a, jet2 b) {
  const jet2 r = {a.f * b.f,
                  a.f * b.xi + a.xi * b.f,
                  a.f * b.eta + a.eta * b.f,
                  a.f * b.xixi + K(2) * a.xi * b.xi + a.xixi * b.f,
                  a.f * b.xieta + a.xi * b.eta + a.eta * b.xi + a.xieta * b.f,
                  a.f * b.etaeta + K(2) * a.eta * b.eta + a.etaeta * b.f};
  return r;
}
FN jet2 inverse_jet2(jet2 a) {
  const real f = K(1) / a.f, f2 = -f * f, f3 = K(-2) * f * f2;
  const jet2 r = {f,
                  f2 * a.xi,
                  f2 * a.eta,
                  f2 * a.xixi + f3 * a.xi * a.xi,
                  f2 * a.xieta + f3 * a.xi * a.eta,
                  f2 * a.etaeta + f3 * a.eta * a.eta};
  return r;
}
// (p - q) / (p + q), as blend_corner.
FN jet2 blend_jet2(jet2 p, jet2 q) {
  return mul_jet2(sum_jet2(p, K(-1), q), inverse_jet2(sum_jet2(p, K(1), q)));
}

FN void put_jet2(GLOBAL_OUT scalar* out, int stride, jet2 a) {
  const real all[JET2_REALS] = {a.f, a.xi, a.eta, a.xixi, a.xieta, a.etaeta};
  for (int i = 0; i < JET2_REALS; ++i) out[i * stride] = all[i];
}

FN void fill_quad_second(real xi, real eta, int stride, GLOBAL_OUT scalar* out) {
  const real one_half = K(0.5f);
  const jet2 one = linear_jet2(K(1), K(0), K(0));
  const jet2 u = linear_jet2(one_half * (K(1) - xi + eta), -one_half, one_half),
             v = linear_jet2(one_half * (K(1) - xi - eta), -one_half, -one_half);
  const jet2 u1 = sum_jet2(one, K(-1), u), v1 = sum_jet2(one, K(-1), v);
  for (int k = 0; k < 4; ++k) {
    const int far_u = k == 1 || k == 2, far_v = k > 1;
    const jet2 p = far_u ? u1 : u, q = far_v ? v1 : v, p1 = far_u ? u : u1, q1 = far_v ? v : v1;
    const jet2 a = mul_jet2(p, mul_jet2(p1, p1)), b = mul_jet2(q, mul_jet2(q1, q1));
    put_jet2(out + k * JET2_REALS * stride, stride, mul_jet2(mul_jet2(a, b), blend_jet2(p, q)));
  }
}

FN void fill_triangle_second(GLOBAL scalar* domain, real xi, real eta, int stride,
                             GLOBAL_OUT scalar* out) {
  GLOBAL scalar* corner = domain + DOMAIN_HEAD + DOMAIN_CORNER;
  const real two_thirds = K(2) / K(3), a_xi = two_thirds * corner[0],
             a_eta = two_thirds * corner[1], b_xi = two_thirds * corner[DOMAIN_STRIDE],
             b_eta = two_thirds * corner[DOMAIN_STRIDE + 1];
  const barycentric x = barycentric_at(domain, xi, eta);
  const jet2 at[3] = {linear_jet2(x.a, a_xi, a_eta), linear_jet2(x.b, b_xi, b_eta),
                      linear_jet2(K(1) - x.a - x.b, -a_xi - b_xi, -a_eta - b_eta)};
  for (int k = 0; k < 3; ++k) out[k * stride] = at[k].f;
  const sextic_powers pa = powers_of(at[0].f), pb = powers_of(at[1].f), pc = powers_of(at[2].f);
  const scalar factorial[5] = {K(1), K(1), K(2), K(6), K(24)};
  GLOBAL_OUT scalar* weight = out + 3 * stride;
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < 5 - k; ++j, weight += stride) {
      const int i = 4 - j - k;
      *weight =
          K(24) / (factorial[i] * factorial[j] * factorial[k]) * (pa.x[i] * (pb.x[j] * pc.x[k]));
    }
  }
  const jet2 all = mul_jet2(mul_jet2(at[0], at[1]), at[2]);
  for (int k = 0; k < 3; ++k) {
    const jet2 cube = mul_jet2(at[k], mul_jet2(at[k], at[k]));
    put_jet2(weight + k * JET2_REALS * stride, stride,
             mul_jet2(mul_jet2(cube, all), blend_jet2(at[(k + 1) % 3], at[(k + 2) % 3])));
  }
}

FN jet2 distance_jet2(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  const jet d = side_distance(domain, n, wrap(k, n), xi, eta);
  return linear_jet2(d.f, d.xi, d.eta);
}
// a / (a + b)
FN jet2 share_jet2(jet2 a, jet2 b) { return mul_jet2(a, inverse_jet2(sum_jet2(a, K(1), b))); }

// u_k of eq. 3; rest_jet2 is 1 - u_k.
FN jet2 parameter_jet2(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  return share_jet2(distance_jet2(domain, n, k - 1, xi, eta),
                    distance_jet2(domain, n, k + 1, xi, eta));
}
FN jet2 rest_jet2(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  return share_jet2(distance_jet2(domain, n, k + 1, xi, eta),
                    distance_jet2(domain, n, k - 1, xi, eta));
}

// Fills in shares of 1, in proportion to the products of squared distances to all sides but the
// corner's two
// (`spared` 2, eq. 5) or the side itself (1).
FN void fill_weights(GLOBAL scalar* domain, int n, int spared, real xi, real eta, jet2* weight) {
  jet2 total = linear_jet2(K(0), K(0), K(0));
  for (int k = 0; k < n; ++k) {
    weight[k] = linear_jet2(K(1), K(0), K(0));
    for (int i = 1; i <= n - spared; ++i)
      weight[k] = mul_jet2(weight[k], distance_jet2(domain, n, k + i, xi, eta));
    weight[k] = mul_jet2(weight[k], weight[k]);
    total = sum_jet2(total, K(1), weight[k]);
  }
  const jet2 over = inverse_jet2(total);
  for (int k = 0; k < n; ++k) weight[k] = mul_jet2(weight[k], over);
}

FN void fill_blend_second(GLOBAL scalar* domain, int n, real xi, real eta, int stride,
                          GLOBAL_OUT scalar* out) {
  const jet2 minus_one = linear_jet2(K(-1), K(0), K(0));
  jet2 weight[SECOND_MOST_SIDES];
  fill_weights(domain, n, 2, xi, eta, weight);
  for (int k = 0; k < n; ++k) {
    // Corner k takes away w (V + v T_k(0) + u T_(k-1)(1) + twist) (eq. 2).
    const int step = JET2_REALS * stride;
    GLOBAL_OUT scalar* rows = out + k * SECOND_BLEND_ROWS * stride;
    GLOBAL_OUT scalar* before = out + wrap(k - 1, n) * SECOND_BLEND_ROWS * stride;
    const jet2 u = parameter_jet2(domain, n, k, xi, eta),
               v = rest_jet2(domain, n, wrap(k - 1, n), xi, eta);
    const jet2 minus = mul_jet2(minus_one, weight[k]);
    const jet2 on_v = mul_jet2(minus, v), on_u = mul_jet2(minus, u);
    put_jet2(rows, stride, u);
    put_jet2(rows + step, stride, minus);
    put_jet2(rows + 2 * step, stride, on_v);
    put_jet2(before + 3 * step, stride, on_u);
    put_jet2(rows + 4 * step, stride, mul_jet2(mul_jet2(on_v, u), share_jet2(v, u)));
    // T_Q runs against side k-1, hence the sign of its derivative.
    put_jet2(before + 5 * step, stride,
             mul_jet2(minus_one, mul_jet2(mul_jet2(on_u, v), share_jet2(u, v))));
  }
}

FN void fill_curved_second(GLOBAL scalar* domain, int n, real xi, real eta, int stride,
                           GLOBAL_OUT scalar* out) {
  jet2 weight[SECOND_MOST_SIDES];
  fill_weights(domain, n, 1, xi, eta, weight);
  for (int k = 0; k < n; ++k) {
    GLOBAL_OUT scalar* rows = out + k * SECOND_CURVED_ROWS * stride;
    put_jet2(rows, stride, parameter_jet2(domain, n, k, xi, eta));
    put_jet2(rows + JET2_REALS * stride, stride, weight[k]);
  }
}

// The table of the probes [2][stride].
FN void fill_second(GLOBAL scalar* domain, uint form, int n, GLOBAL scalar* probe, int stride,
                    GLOBAL_OUT scalar* out) {
  for (int i = 0; i < stride; ++i) {
    const real xi = probe[i], eta = probe[stride + i];
    if (form == FORM_SEXTIC) {
      fill_triangle_second(domain, xi, eta, stride, out + i);
    } else if (form == FORM_BEZIER) {
      fill_quad_second(xi, eta, stride, out + i);
    } else if (form == FORM_CURVED) {
      fill_curved_second(domain, n, xi, eta, stride, out + i);
    } else {
      fill_blend_second(domain, n, xi, eta, stride, out + i);
    }
  }
}
