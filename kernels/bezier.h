// Patches of three and four sides as single polynomials, but for their inner control points, which
// blend one for each of the two sides at a corner: the Gregory quad of 20 points (bicubic) and the
// Gregory triangle of 15 (quartic, with cubic boundary curves). Cross tangents are cubic,
// T = k C' + h m as in ribbon.h with k linear and h quadratic.
//   Chiyokura and Kimura 1983; Longhi 1985.

#define BEZIER_REALS 15  // of a side: 5 triples

// A blended point, A p / (p + q) + B q / (p + q), is its mean (part of the polynomial) and
// (A - B) / 2 times g.
typedef struct {
  real f, p, q;  // g = (p - q) / (p + q) and its derivatives
} corner_blend;

FN corner_blend blend_corner(real p, real q) {
  const real inverse = K(1) / larger(p + q, splat(TINY));
  corner_blend g;
  g.f = (p - q) * inverse;
  g.p = K(2) * q * inverse * inverse;
  g.q = K(-2) * p * inverse * inverse;
  return g;
}

// The polynomial of `count` triples from `first`, with its derivative (Horner).
FN curve_point polynomial(control_data control, int first, int count, real t) {
  curve_point r;
  r.f = load3(control, first + count - 1);
  r.d = zero3();
  UNROLL
  for (int i = count - 2; i >= 0; --i) {
    r.d = i == count - 2 ? r.f : fma3(t, r.d, r.f);
    r.f = fma3(t, r.f, load3(control, first + i));
  }
  return r;
}

// A quad: u along side 0, v along side 3 backwards. 16 triples are the mean's coefficients of
// u^i v^j, [j][i]; 4 are the halved differences, times 9, of the corners in their order: A of the
// sides along u, B of those along v.
#define QUAD_DIFFERENCE 16

// Adds a corner's halved difference, blended; f stands for the derivatives along u and v in xi and
// eta.
FN patch_point add_quad_corner(patch_point p, real3 difference, jet a, jet b, corner_blend g,
                               real along_u, real along_v) {
  const real ab = a.f * b.f;
  const jet f = make_jet(ab * g.f, b.f * fma(a.xi, g.f, a.f * g.p * along_u),
                         a.f * fma(b.xi, g.f, b.f * g.q * along_v));
  return add_constant(p, f, difference);
}

FN patch_point gregory_quad(control_data control, real xi, real eta) {
  const real one = splat(K(1));
  const real u = K(0.5f) * (one - xi + eta), v = K(0.5f) * (one - xi - eta);
  const curve_point r0 = polynomial(control, 0, 4, u), r1 = polynomial(control, 4, 4, u),
                    r2 = polynomial(control, 8, 4, u), r3 = polynomial(control, 12, 4, u);
  const real3 s2 = fma3(v, r3.f, r2.f), s1 = fma3(v, s2, r1.f);
  patch_point p;
  p.g = fma3(v, s1, r0.f);
  p.g_xi = fma3(v, fma3(v, fma3(v, r3.d, r2.d), r1.d), r0.d);
  p.g_eta = fma3(v, fma3(v, r3.f, s2), s1);
  // Distances to the four sides, never negative; p (1-p)^2 and the like, with their derivatives.
  const real zero = splat(K(0)), p0 = larger(u, zero), p1 = larger(one - u, zero),
             q0 = larger(v, zero), q1 = larger(one - v, zero);
  const real pp = p0 * p1, qq = q0 * q1;
  const jet u0 = make_jet(pp * p1, p1 * (p1 - K(2) * p0), zero),
            u1 = make_jet(pp * p0, p0 * (K(2) * p1 - p0), zero),
            v0 = make_jet(qq * q1, q1 * (q1 - K(2) * q0), zero),
            v1 = make_jet(qq * q0, q0 * (K(2) * q1 - q0), zero);
  const real minus = splat(K(-1));
  p = add_quad_corner(p, load3(control, QUAD_DIFFERENCE + 0), u0, v0, blend_corner(p0, q0), one,
                      one);
  p = add_quad_corner(p, load3(control, QUAD_DIFFERENCE + 1), u1, v0, blend_corner(p1, q0), minus,
                      one);
  p = add_quad_corner(p, load3(control, QUAD_DIFFERENCE + 2), u1, v1, blend_corner(p1, q1), minus,
                      minus);
  p = add_quad_corner(p, load3(control, QUAD_DIFFERENCE + 3), u0, v1, blend_corner(p0, q1), one,
                      minus);
  patch_point r;
  r.g = p.g;
  r.g_xi = mul3(splat(K(-0.5f)), add3(p.g_xi, p.g_eta));
  r.g_eta = mul3(splat(K(0.5f)), sub3(p.g_xi, p.g_eta));
  return r;
}

// A triangle: a, b, c are the barycentric coordinates of corners 0, 1, 2. 10 triples are
// coefficients of a^i b^j, by j and then i; then, times abc, what the inner points of corners 0 and
// 1 add to that of corner 2; and the halved differences of the three: A of the side that starts
// there, B of the one that ends.
#define TRIANGLE_INNER 10
#define TRIANGLE_DIFFERENCE 12

// G += l abc g x, with the derivatives along a and b in xi and eta; l and abc as jets.
FN patch_point add_triangle_corner(patch_point p, control_data control, int k, jet l, real g,
                                   real g_a, real g_b) {
  const jet f = make_jet(l.f * g, fma(l.xi, g, l.f * g_a), fma(l.eta, g, l.f * g_b));
  return add_constant(p, f, load3(control, TRIANGLE_DIFFERENCE + k));
}

// Barycentric coordinates of a triangle's domain, of corners 0, 1, 2: never negative.
typedef struct {
  real a, b, c;
} barycentric;

FN barycentric barycentric_at(GLOBAL scalar* domain, real xi, real eta) {
  GLOBAL scalar* corner = domain + DOMAIN_HEAD + DOMAIN_CORNER;
  const real third = splat(K(1) / K(3)), two_thirds = splat(K(2) / K(3));
  real at[3];
  for (int k = 0; k < 3; ++k) {
    GLOBAL scalar* c = corner + DOMAIN_STRIDE * k;
    at[k] = larger(fma(two_thirds, fma(splat(c[0]), xi, splat(c[1]) * eta), third), splat(K(0)));
  }
  const barycentric r = {at[0], at[1], at[2]};
  return r;
}

// The derivatives along a and b, given in xi and eta, as those along xi and eta.
FN patch_point along_domain(GLOBAL scalar* domain, patch_point p) {
  GLOBAL scalar* corner = domain + DOMAIN_HEAD + DOMAIN_CORNER;
  const real two_thirds = splat(K(2) / K(3));
  const real a_xi = two_thirds * corner[0], a_eta = two_thirds * corner[1],
             b_xi = two_thirds * corner[DOMAIN_STRIDE],
             b_eta = two_thirds * corner[DOMAIN_STRIDE + 1];
  patch_point r;
  r.g = p.g;
  r.g_xi = fma3(b_xi, p.g_eta, mul3(a_xi, p.g_xi));
  r.g_eta = fma3(b_eta, p.g_eta, mul3(a_eta, p.g_xi));
  return r;
}

FN patch_point gregory_triangle(GLOBAL scalar* domain, control_data control, real xi, real eta) {
  const barycentric x = barycentric_at(domain, xi, eta);
  const real a = x.a, b = x.b, c = x.c;
  const curve_point r0 = polynomial(control, 0, 4, a), r1 = polynomial(control, 4, 3, a),
                    r2 = polynomial(control, 7, 2, a);
  const real3 s2 = fma3(b, load3(control, 9), r2.f), s1 = fma3(b, s2, r1.f);
  patch_point p;
  p.g = fma3(b, s1, r0.f);
  p.g_xi = fma3(b, fma3(b, r2.d, r1.d), r0.d);
  p.g_eta = fma3(b, fma3(b, load3(control, 9), s2), s1);
  const real ab = a * b, bc = b * c, ac = a * c, abc = ab * c;
  const real abc_a = bc - ab, abc_b = ac - ab;
  const jet la = make_jet(a * abc, fma(a, abc_a, abc), a * abc_b),
            lb = make_jet(b * abc, b * abc_a, fma(b, abc_b, abc)),
            lc = make_jet(c * abc, fma(c, abc_a, -abc), fma(c, abc_b, -abc));
  p = add_constant(p, la, load3(control, TRIANGLE_INNER));
  p = add_constant(p, lb, load3(control, TRIANGLE_INNER + 1));
  const corner_blend g0 = blend_corner(b, c), g1 = blend_corner(c, a), g2 = blend_corner(a, b);
  p = add_triangle_corner(p, control, 0, la, g0.f, -g0.q, g0.p - g0.q);
  p = add_triangle_corner(p, control, 1, lb, g1.f, g1.q - g1.p, -g1.p);
  p = add_triangle_corner(p, control, 2, lc, g2.f, g2.p, g2.q);
  return along_domain(domain, p);
}
