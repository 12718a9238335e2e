// Second derivatives of the patches that are polynomials but for their blended control points
// (bezier.h, sextic.h), at the probes of examine.h. What depends on the place alone comes from a
// table, made on the host: how the blends of corners change, and the Bernstein polynomials of a
// triangle.

#define JET2_REALS 6  // a number with its first and second derivatives
// Rows of the table. A quad's: its four corners' blends. A triangle's: a, b, c, then the Bernstein
// polynomials of degree 4, by k and then j, then the three corners' blends.
#define SECOND_QUAD_ROWS (4 * JET2_REALS)
#define SECOND_WEIGHTS 15
#define SECOND_TRIANGLE_ROWS (3 + SECOND_WEIGHTS + 3 * JET2_REALS)

// Rows of the forms that have second derivatives; 0: none.
FN int second_rows(uint form, int n) {
  if (form == FORM_BEZIER && n == 4) return SECOND_QUAD_ROWS;
  return form == FORM_SEXTIC ? SECOND_TRIANGLE_ROWS : 0;
}

// G with its first and second derivatives.
typedef struct {
  patch_point p;
  real3 xixi, xieta, etaeta;
} patch_jet;

// G += f x, f from six rows.
FN patch_jet add_blend(patch_jet g, GLOBAL scalar* rows, int stride, real3 x) {
  g.p.g = fma3(load_lanes(rows), x, g.p.g);
  g.p.g_xi = fma3(load_lanes(rows + stride), x, g.p.g_xi);
  g.p.g_eta = fma3(load_lanes(rows + 2 * stride), x, g.p.g_eta);
  g.xixi = fma3(load_lanes(rows + 3 * stride), x, g.xixi);
  g.xieta = fma3(load_lanes(rows + 4 * stride), x, g.xieta);
  g.etaeta = fma3(load_lanes(rows + 5 * stride), x, g.etaeta);
  return g;
}

// A cubic with its derivative and half its second one (Horner).
typedef struct {
  real3 f, d, h;
} curve_jet;

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
    g = add_blend(g, table + k * JET2_REALS * stride, stride, load3(control, QUAD_DIFFERENCE + k));
  return g;
}

FN patch_jet triangle_jet(GLOBAL scalar* domain, control_data control, GLOBAL scalar* table,
                          int stride) {
  const real a = load_lanes(table), b = load_lanes(table + stride),
             c = load_lanes(table + 2 * stride);
  GLOBAL scalar* weight = table + 3 * stride;
  // The six points of the step of de Casteljau's algorithm before the last but one.
  const real3 none = make3(splat(K(0)), splat(K(0)), splat(K(0)));
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
    g = add_blend(g, weight + k * JET2_REALS * stride, stride,
                  load3(control, SEXTIC_DIFFERENCE + k));
  return g;
}
