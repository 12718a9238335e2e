// The Gregory triangle of degree 6: boundary curves of degree 5, cross tangents of degree 5, and at
// each corner an inner control point that blends one for each of its two sides. Its control data
// come from fair.h.
//   Longhi 1985; Farin 2002, 17: Bezier triangles and their derivatives.

// 28 Bezier points P_ijk of a^i b^j c^k, i + j + k = 6, by k and then j; the points 411, 141 and
// 114 are the means of the two that they blend. Then their halved differences, times 30: of the
// side that starts at the corner, less that of the side that ends there.
#define SEXTIC_POINTS 28
#define SEXTIC_DIFFERENCE SEXTIC_POINTS
#define SEXTIC_REALS 31  // of a side: (28 + 3) triples over three

// Where P_ijk stands.
FN int sextic_point(int j, int k) { return k * (15 - k) / 2 + j; }

// Bezier point i of 0 to 6 of a side.
FN real3 sextic_boundary(control_data control, int side, int i) {
  const int at = side == 0   ? sextic_point(i, 0)
                 : side == 1 ? sextic_point(6 - i, i)
                             : sextic_point(0, 6 - i);
  return load3(control, at);
}

// 1, x, x^2 ... x^5.
typedef struct {
  real x[6];
} sextic_powers;

FN sextic_powers powers_of(real x) {
  sextic_powers r;
  r.x[0] = splat(K(1));
  UNROLL
  for (int i = 1; i < 6; ++i) r.x[i] = r.x[i - 1] * x;
  return r;
}

// The three points of the last step of de Casteljau's algorithm, from the Bernstein polynomials of
// degree 5: every term is positive, so that nothing cancels.
typedef struct {
  real3 a, b, c;
} sextic_simplex;

FN sextic_simplex sextic_at(control_data control, real a, real b, real c) {
  const sextic_powers pa = powers_of(a), pb = powers_of(b), pc = powers_of(c);
  const scalar factorial[6] = {K(1), K(1), K(2), K(6), K(24), K(120)};
  const real3 zero = zero3();
  sextic_simplex r = {zero, zero, zero};
  UNROLL
  for (int k = 0; k < 6; ++k) {
    UNROLL
    for (int j = 0; j < 6 - k; ++j) {
      const int i = 5 - j - k;
      const scalar count = K(120) / (factorial[i] * factorial[j] * factorial[k]);
      const real weight = splat(count) * (pa.x[i] * (pb.x[j] * pc.x[k]));
      r.a = fma3(weight, load3(control, sextic_point(j, k)), r.a);
      r.b = fma3(weight, load3(control, sextic_point(j + 1, k)), r.b);
      r.c = fma3(weight, load3(control, sextic_point(j, k + 1)), r.c);
    }
  }
  return r;
}

// G += l g x of a corner's difference x, with the derivatives along a and b in xi and eta; l is a^3
// abc and its like.
FN patch_point add_sextic_corner(patch_point p, control_data control, int corner, jet l, real g,
                                 real g_a, real g_b) {
  const jet f = make_jet(l.f * g, fma(l.xi, g, l.f * g_a), fma(l.eta, g, l.f * g_b));
  return add_constant(p, f, load3(control, SEXTIC_DIFFERENCE + corner));
}

FN patch_point sextic_triangle(GLOBAL scalar* domain, control_data control, real xi, real eta) {
  const barycentric x = barycentric_at(domain, xi, eta);
  // The sum of all three is 1 to a rounding of c alone.
  const real a = x.a, b = x.b, c = larger(splat(K(1)) - a - b, splat(K(0)));
  const sextic_simplex s = sextic_at(control, a, b, c);
  patch_point p;
  p.g = fma3(a, s.a, fma3(b, s.b, mul3(c, s.c)));
  p.g_xi = mul3(splat(K(6)), sub3(s.a, s.c));
  p.g_eta = mul3(splat(K(6)), sub3(s.b, s.c));
  const real ab = a * b, bc = b * c, ac = a * c, abc = ab * c;
  const real abc_a = bc - ab, abc_b = ac - ab;
  const real a2 = a * a, b2 = b * b, c2 = c * c, three = splat(K(3));
  const jet la = make_jet(a2 * a * abc, a2 * fma(a, abc_a, three * abc), a2 * a * abc_b),
            lb = make_jet(b2 * b * abc, b2 * b * abc_a, b2 * fma(b, abc_b, three * abc)),
            lc = make_jet(c2 * c * abc, c2 * fma(c, abc_a, -three * abc),
                          c2 * fma(c, abc_b, -three * abc));
  const corner_blend g0 = blend_corner(b, c), g1 = blend_corner(c, a), g2 = blend_corner(a, b);
  p = add_sextic_corner(p, control, 0, la, g0.f, -g0.q, g0.p - g0.q);
  p = add_sextic_corner(p, control, 1, lb, g1.f, g1.q - g1.p, -g1.p);
  p = add_sextic_corner(p, control, 2, lc, g2.f, g2.p, g2.q);
  return along_domain(domain, p);
}
