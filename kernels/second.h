// Second derivatives of patches at the probes of examine.h. What depends on the place alone comes
// from a table, made on the host: how the blends of corners change, the Bernstein polynomials of a
// triangle, and the parameters and weights of sides.

#define JET2_REALS 6  // a number with its first and second derivatives
// Rows of the table. A quad (bezier.h) has its four corners' blends. A triangle (sextic.h) has a,
// b, c, then the Bernstein polynomials of degree 4, by k and then j, then the three corners'
// blends.
#define SECOND_QUAD_ROWS (4 * JET2_REALS)
#define SECOND_WEIGHTS 15
#define SECOND_TRIANGLE_ROWS (3 + SECOND_WEIGHTS + 3 * JET2_REALS)
// A side of curved.h has u_k and its share of the weights.
#define SECOND_CURVED_ROWS (2 * JET2_REALS)
// A side of patch.h, whose forms share the table, has u_k, then the factors of V_k, T_k(0), T_k(1),
// T_k'(0) and T_k'(1) in G.
#define SECOND_BLEND_ROWS (6 * JET2_REALS)
// Tables of more sides would be larger than caches.
#define SECOND_MOST_SIDES 8

// Rows of the forms that have second derivatives; 0: none.
FN int second_rows(uint form, int n) {
  if (form == FORM_BEZIER && n == 4) return SECOND_QUAD_ROWS;
  if (form == FORM_SEXTIC) return SECOND_TRIANGLE_ROWS;
  if (n > SECOND_MOST_SIDES) return 0;
  return BLENDS_SIDES(form)    ? n * SECOND_BLEND_ROWS
         : form == FORM_CURVED ? n * SECOND_CURVED_ROWS
                               : 0;
}

// A number with its first and second derivatives.
typedef struct {
  real f, xi, eta, xixi, xieta, etaeta;
} jet2;

FN jet2 load_jet2(GLOBAL scalar* rows, int stride) {
  const jet2 r = {load_lanes(rows),
                  load_lanes(rows + stride),
                  load_lanes(rows + 2 * stride),
                  load_lanes(rows + 3 * stride),
                  load_lanes(rows + 4 * stride),
                  load_lanes(rows + 5 * stride)};
  return r;
}
// a + s b
FN jet2 sum_jet2(jet2 a, scalar s, jet2 b) {
  const jet2 r = {a.f + s * b.f,       a.xi + s * b.xi,       a.eta + s * b.eta,
                  a.xixi + s * b.xixi, a.xieta + s * b.xieta, a.etaeta + s * b.etaeta};
  return r;
}
FN jet2 minus_sum_jet2(jet2 a, jet2 b) {
  const jet2 r = {-(a.f + b.f),       -(a.xi + b.xi),       -(a.eta + b.eta),
                  -(a.xixi + b.xixi), -(a.xieta + b.xieta), -(a.etaeta + b.etaeta)};
  return r;
}

// G with its first and second derivatives.
typedef struct {
  patch_point p;
  real3 xixi, xieta, etaeta;
} patch_jet;

// G += f x
FN patch_jet add_blend(patch_jet g, jet2 f, real3 x) {
  g.p.g = fma3(f.f, x, g.p.g);
  g.p.g_xi = fma3(f.xi, x, g.p.g_xi);
  g.p.g_eta = fma3(f.eta, x, g.p.g_eta);
  g.xixi = fma3(f.xixi, x, g.xixi);
  g.xieta = fma3(f.xieta, x, g.xieta);
  g.etaeta = fma3(f.etaeta, x, g.etaeta);
  return g;
}
// G += w x(u)
FN patch_jet add_along(patch_jet g, jet2 w, jet2 u, curve_jet x) {
  const real two = splat(K(2)), w_xi = w.f * u.xi, w_eta = w.f * u.eta;
  g = add_blend(g, w, x.f);
  g.p.g_xi = fma3(w_xi, x.d, g.p.g_xi);
  g.p.g_eta = fma3(w_eta, x.d, g.p.g_eta);
  g.xixi = fma3(two * w_xi * u.xi, x.h, fma3(fma(two * w.xi, u.xi, w.f * u.xixi), x.d, g.xixi));
  g.xieta = fma3(two * w_xi * u.eta, x.h,
                 fma3(fma(w.xi, u.eta, fma(w.eta, u.xi, w.f * u.xieta)), x.d, g.xieta));
  g.etaeta =
      fma3(two * w_eta * u.eta, x.h, fma3(fma(two * w.eta, u.eta, w.f * u.etaeta), x.d, g.etaeta));
  return g;
}

FN patch_jet no_jet() {
  const real3 none = zero3();
  const patch_jet g = {{none, none, none}, none, none, none};
  return g;
}

// The sum of patch.h, of FORM_PAPER and FORM_RIBBON.
FN_APART patch_jet blend_jet(control_data control, uint form, int n, GLOBAL scalar* table,
                             int stride) {
  const int reals = side_reals(form);
  patch_jet g = no_jet();
  for (int k = 0; k < n; ++k) {
    control_data side = control + k * reals;
    GLOBAL scalar* rows = table + k * SECOND_BLEND_ROWS * stride;
    GLOBAL scalar* next = table + wrap(k + 1, n) * SECOND_BLEND_ROWS * stride;
    const int step = JET2_REALS * stride;
    const jet2 u = load_jet2(rows, stride), corner = load_jet2(rows + step, stride),
               start = load_jet2(rows + 2 * step, stride), end = load_jet2(rows + 3 * step, stride);
    // C(u) and T(u) have of the weights what their ends are taken away with.
    const jet2 on_curve = minus_sum_jet2(corner, load_jet2(next + step, stride)),
               on_tangent = minus_sum_jet2(start, end);
    g = add_along(g, on_curve, u,
                  cubic_jet(load3(side, SIDE_C), load3(side, SIDE_C + 1), load3(side, SIDE_C + 2),
                            load3(side, SIDE_C + 3), u.f));
    g = add_along(g, on_tangent, u,
                  IS_FORM(form, FORM_RIBBON) ? ribbon_tangent(side, u.f)
                                             : cross_tangent(side, u.f, K(1) - u.f));
    g = add_blend(g, corner, load3(side, SIDE_C));
    g = add_blend(g, start, load3(side, SIDE_T_0));
    g = add_blend(g, end, load3(side, SIDE_T_1));
    g = add_blend(g, load_jet2(rows + 4 * step, stride), load3(side, SIDE_TWIST_0));
    g = add_blend(g, load_jet2(rows + 5 * step, stride), load3(side, SIDE_TWIST_1));
  }
  return g;
}

// The polynomial of `count` triples from `first`, two at least (Horner).
FN curve_jet polynomial_jet(control_data control, int first, int count, real t) {
  const real3 none = zero3();
  curve_jet r = {load3(control, first + count - 1), none, none};
  UNROLL
  for (int i = count - 2; i >= 0; --i) {
    r.h = i == count - 2 ? none : i == count - 3 ? r.d : fma3(t, r.h, r.d);
    r.d = i == count - 2 ? r.f : fma3(t, r.d, r.f);
    r.f = fma3(t, r.f, load3(control, first + i));
  }
  return r;
}

// The sum of curved.h. Weights change fast near a corner: their derivatives add up to nothing but
// for roundings, which are taken away again.
FN_APART patch_jet curved_jet(GLOBAL scalar* domain, control_data control, int n, real xi, real eta,
                              GLOBAL scalar* table, int stride) {
  const real two = splat(K(2)), three = splat(K(3));
  const real none = splat(K(0));
  jet2 total = {none, none, none, none, none, none};
  patch_jet g = no_jet();
  for (int k = 0; k < n; ++k) {
    control_data side = control + k * CURVED_REALS;
    GLOBAL scalar* rows = table + k * SECOND_CURVED_ROWS * stride;
    const jet2 u = load_jet2(rows, stride), w = load_jet2(rows + JET2_REALS * stride, stride);
    total = sum_jet2(total, K(1), w);
    const jet d = side_distance(domain, n, k, xi, eta);
    const real3 p0 = load3(side, CURVED_C), p1 = load3(side, CURVED_C + 1),
                p2 = load3(side, CURVED_C + 2), p3 = load3(side, CURVED_C + 3);
    const real3 a = sub3(p1, p0), b = sub3(p2, p1), ab = sub3(b, a);
    const curve_jet c =
        cubic_jet(p0, mul3(three, a), mul3(three, ab), sub3(sub3(sub3(p3, p2), b), ab), u.f);
    const curve_jet t = polynomial_jet(side, CURVED_T, 5, u.f),
                    q = polynomial_jet(side, CURVED_Q, 3, u.f);
    // R along u alone, then along d: R_d, R_ud and R_dd / 2.
    const real3 slope = fma3(d.f, q.f, t.f), dslope = fma3(d.f, q.d, t.d);
    const curve_jet r = {fma3(d.f, slope, c.f), fma3(d.f, dslope, c.d),
                         fma3(d.f, fma3(d.f, q.h, t.h), c.h)};
    const real3 r_d = fma3(d.f, q.f, slope), r_ud = fma3(d.f, q.d, dslope);
    g = add_along(g, w, u, r);
    const real w_xi = w.f * d.xi, w_eta = w.f * d.eta;
    g.p.g_xi = fma3(w_xi, r_d, g.p.g_xi);
    g.p.g_eta = fma3(w_eta, r_d, g.p.g_eta);
    g.xixi = fma3(two * w.xi * d.xi, r_d,
                  fma3(two * w_xi * u.xi, r_ud, fma3(two * w_xi * d.xi, q.f, g.xixi)));
    g.xieta =
        fma3(fma(w.xi, d.eta, w.eta * d.xi), r_d,
             fma3(fma(w_eta, u.xi, w_xi * u.eta), r_ud, fma3(two * w_xi * d.eta, q.f, g.xieta)));
    g.etaeta = fma3(two * w.eta * d.eta, r_d,
                    fma3(two * w_eta * u.eta, r_ud, fma3(two * w_eta * d.eta, q.f, g.etaeta)));
  }
  g.p.g_xi = fma3(-total.xi, g.p.g, g.p.g_xi);
  g.p.g_eta = fma3(-total.eta, g.p.g, g.p.g_eta);
  g.xixi = fma3(-total.xixi, g.p.g, g.xixi);
  g.xieta = fma3(-total.xieta, g.p.g, g.xieta);
  g.etaeta = fma3(-total.etaeta, g.p.g, g.etaeta);
  return g;
}

FN patch_jet quad_jet(control_data control, real xi, real eta, GLOBAL scalar* table, int stride) {
  const real middle = splat(K(0.5f)), one = splat(K(1));
  const real u = middle * (one - xi + eta), v = middle * (one - xi - eta);
  curve_jet r[4];
  UNROLL
  for (int j = 0; j < 4; ++j) {
    const int at = 4 * j;
    r[j] = cubic_jet(load3(control, at), load3(control, at + 1), load3(control, at + 2),
                     load3(control, at + 3), u);
  }
  const curve_jet f = cubic_jet(r[0].f, r[1].f, r[2].f, r[3].f, v),
                  d = cubic_jet(r[0].d, r[1].d, r[2].d, r[3].d, v);
  const real3 h = fma3(v, fma3(v, fma3(v, r[3].h, r[2].h), r[1].h), r[0].h);
  // (G_uu + G_vv) / 2 and (G_vv - G_uu) / 2.
  const real3 both = add3(h, f.h), apart = sub3(f.h, h);
  patch_jet g;
  g.p.g = f.f;
  g.p.g_xi = mul3(-middle, add3(d.f, f.d));
  g.p.g_eta = mul3(middle, sub3(d.f, f.d));
  g.xixi = mul3(middle, add3(both, d.d));
  g.xieta = mul3(middle, apart);
  g.etaeta = mul3(middle, sub3(both, d.d));
  UNROLL
  for (int k = 0; k < 4; ++k)
    g = add_blend(g, load_jet2(table + k * JET2_REALS * stride, stride),
                  load3(control, QUAD_DIFFERENCE + k));
  return g;
}

FN patch_jet triangle_jet(GLOBAL scalar* domain, control_data control, GLOBAL scalar* table,
                          int stride) {
  const real a = load_lanes(table), b = load_lanes(table + stride),
             c = load_lanes(table + 2 * stride);
  GLOBAL scalar* weight = table + 3 * stride;
  // The six points of the step of de Casteljau's algorithm before the last but one.
  const real3 none = zero3();
  real3 aa = none, bb = none, cc = none, ab = none, ac = none, bc = none;
  UNROLL
  for (int k = 0; k < 5; ++k) {
    UNROLL
    for (int j = 0; j < 5 - k; ++j, weight += stride) {
      const real w = load_lanes(weight);
      aa = fma3(w, load3(control, sextic_point(j, k)), aa);
      ab = fma3(w, load3(control, sextic_point(j + 1, k)), ab);
      bb = fma3(w, load3(control, sextic_point(j + 2, k)), bb);
      ac = fma3(w, load3(control, sextic_point(j, k + 1)), ac);
      bc = fma3(w, load3(control, sextic_point(j + 1, k + 1)), bc);
      cc = fma3(w, load3(control, sextic_point(j, k + 2)), cc);
    }
  }
  const real3 pa = fma3(a, aa, fma3(b, ab, mul3(c, ac))),
              pb = fma3(a, ab, fma3(b, bb, mul3(c, bc))),
              pc = fma3(a, ac, fma3(b, bc, mul3(c, cc)));
  patch_point p;
  p.g = fma3(a, pa, fma3(b, pb, mul3(c, pc)));
  p.g_xi = mul3(splat(K(6)), sub3(pa, pc));
  p.g_eta = mul3(splat(K(6)), sub3(pb, pc));
  patch_jet g;
  g.p = along_domain(domain, p);
  // Second derivatives along a and b, over 30.
  const real3 d_ac = sub3(aa, ac), d_ca = sub3(cc, ac), d_bc = sub3(bb, bc), d_cb = sub3(cc, bc);
  const real3 p_aa = add3(d_ac, d_ca), p_bb = add3(d_bc, d_cb), p_ab = add3(sub3(ab, ac), d_cb);
  GLOBAL scalar* corner = domain + DOMAIN_HEAD + DOMAIN_CORNER;
  const real two_thirds = splat(K(2) / K(3)), most = splat(K(30));
  const real a_xi = two_thirds * corner[0], a_eta = two_thirds * corner[1],
             b_xi = two_thirds * corner[DOMAIN_STRIDE],
             b_eta = two_thirds * corner[DOMAIN_STRIDE + 1];
  g.xixi =
      mul3(most, fma3(a_xi * a_xi, p_aa, fma3(K(2) * a_xi * b_xi, p_ab, mul3(b_xi * b_xi, p_bb))));
  g.xieta = mul3(most, fma3(a_xi * a_eta, p_aa,
                            fma3(a_xi * b_eta + a_eta * b_xi, p_ab, mul3(b_xi * b_eta, p_bb))));
  g.etaeta = mul3(
      most, fma3(a_eta * a_eta, p_aa, fma3(K(2) * a_eta * b_eta, p_ab, mul3(b_eta * b_eta, p_bb))));
  UNROLL
  for (int k = 0; k < 3; ++k)
    g = add_blend(g, load_jet2(weight + k * JET2_REALS * stride, stride),
                  load3(control, SEXTIC_DIFFERENCE + k));
  return g;
}
