// The nearest point of a triangle, and how far a base polygon is.

typedef struct {
  real v, w;       // barycentric coordinates of b and c
  real3 p;         // the point
  real distance2;  // squared, from x
} triangle_foot;

// Nearest point of triangle a b c to x (Ericson 2005, 5.1.5). Lanes may lie in different regions,
// so that all are decided and the last that holds wins; those of the edges and of the inside share
// one quotient.
FN triangle_foot foot_on_triangle(real3 a, real3 b, real3 c, real3 x) {
  const real3 ab = sub3(b, a), ac = sub3(c, a), ax = sub3(x, a), bx = sub3(x, b), cx = sub3(x, c);
  const real d1 = dot3(ab, ax), d2 = dot3(ac, ax), d3 = dot3(ab, bx), d4 = dot3(ac, bx),
             d5 = dot3(ab, cx), d6 = dot3(ac, cx);
  const real vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  const real zero = splat(K(0)), one = splat(K(1)), along = d4 - d3, back = d5 - d6;
  // An edge of no length holds nothing that its neighbour does not.
  const mask on_bc = (va <= zero) & (along >= zero) & (back >= zero) & (along + back > zero);
  const mask on_ac = (vb <= zero) & (d2 >= zero) & (d6 <= zero) & (d2 - d6 > zero);
  const mask on_ab = (vc <= zero) & (d1 >= zero) & (d3 <= zero) & (d1 - d3 > zero);
  const mask at_c = (d6 >= zero) & (d5 <= d6), at_b = (d3 >= zero) & (d4 <= d3),
             at_a = (d1 <= zero) & (d2 <= zero);
  const real over = pick(on_ab, d1, pick(on_ac, d2, pick(on_bc, along, one)));
  const real under =
      pick(on_ab, d1 - d3, pick(on_ac, d2 - d6, pick(on_bc, along + back, va + vb + vc)));
  const real t = pick(under > zero, over / under, zero);  // 0: by rounding, of a sliver
  triangle_foot r;
  // Where rounding is more than the triangle, the inside may be anywhere.
  const real v = larger(smaller(vb * t, one), zero), w = larger(smaller(vc * t, one - v), zero);
  r.v = pick(on_ab, t, pick(on_ac, zero, pick(on_bc, one - t, v)));
  r.w = pick(on_ab, zero, pick(on_ac | on_bc, t, w));
  r.v = pick(at_a, zero, pick(at_b, one, pick(at_c, zero, r.v)));
  r.w = pick(at_a | at_b, zero, pick(at_c, one, r.w));
  r.p = fma3(r.v, ab, fma3(r.w, ac, a));
  const real3 away = sub3(r.p, x);
  r.distance2 = dot3(away, away);
  return r;
}

// Squared distance of x to the n - 2 triangles of a base polygon [n][2][3].
FN real polygon_distance2(GLOBAL scalar* corner, GLOBAL uint* triangle, int n, real3 x) {
  const real3 away = sub3(load3(corner, 0), x);
  real least = dot3(away, away);
  for (int t = 0; t < n - 2; ++t) {
    const real3 a = load3(corner, 2 * (int)triangle[3 * t]),
                b = load3(corner, 2 * (int)triangle[3 * t + 1]),
                c = load3(corner, 2 * (int)triangle[3 * t + 2]);
    least = smaller(foot_on_triangle(a, b, c, x).distance2, least);
  }
  return least;
}
