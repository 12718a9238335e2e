// Sides whose curves and cross tangents are polynomials, and the Gregory quad between four of them.
// On the host only.

// C'(0) and C'(1) of a side at a crease, in place of those of eq. 7 to 9; both (0, 0, 0) at others.
typedef struct {
  real3 start, end;
} crease_tangents;

FN crease_tangents load_tangents(control_data tangents, int k) {
  const crease_tangents r = {load3(tangents, 2 * k), load3(tangents, 2 * k + 1)};
  return r;
}

FN mask has_tangents(crease_tangents t) { return dot3(t.start, t.start) > splat(K(0)); }

// The in-plane vector r as k c + h m.
typedef struct {
  real k, h;
} ribbon_coefficients;

FN ribbon_coefficients ribbon_coefficients_of(real3 r, real3 c, real3 m) {
  const real3 across = cross3(c, m);
  const real inverse = K(1) / larger(dot3(across, across), splat(TINY));
  const ribbon_coefficients p = {dot3(cross3(r, m), across) * inverse,
                                 dot3(cross3(c, r), across) * inverse};
  return p;
}

// Bezier points of a side's curve and of its cubic cross tangent.
typedef struct {
  real3 c[4], t[4];
} bezier_side;

FN void to_bezier(real3 p[4]) {  // from powers of t
  const real third = splat(K(1) / K(3)), three = splat(K(3));
  const real3 a = p[0], b = mul3(third, p[1]), c = mul3(third, p[2]), d = p[3];
  p[1] = add3(a, b);
  p[2] = add3(p[1], add3(b, c));
  p[3] = add3(add3(a, mul3(three, b)), add3(mul3(three, c), d));
}

FN void store_quad(const bezier_side* s, control_out out) {
  const real third = splat(K(1) / K(3)), half = splat(K(0.5f));
  real3 p[4][4];  // [j][i]
  for (int i = 0; i < 4; ++i) {
    p[0][i] = s[0].c[i];
    p[i][3] = s[1].c[i];
    p[3][i] = s[2].c[3 - i];
    p[i][0] = s[3].c[3 - i];
  }
  // At each corner: of the side along u, and of that along v.
  const real3 a[4] = {fma3(third, s[0].t[1], p[0][1]), fma3(third, s[0].t[2], p[0][2]),
                      fma3(third, s[2].t[1], p[3][2]), fma3(third, s[2].t[2], p[3][1])};
  const real3 b[4] = {fma3(third, s[3].t[2], p[1][0]), fma3(third, s[1].t[1], p[1][3]),
                      fma3(third, s[1].t[2], p[2][3]), fma3(third, s[3].t[1], p[2][0])};
  p[1][1] = mul3(half, add3(a[0], b[0]));
  p[1][2] = mul3(half, add3(a[1], b[1]));
  p[2][2] = mul3(half, add3(a[2], b[2]));
  p[2][1] = mul3(half, add3(a[3], b[3]));
  // Powers along u, then along v.
  const scalar binomial[4][4] = {
      {K(1)}, {K(-3), K(3)}, {K(3), K(-6), K(3)}, {K(-1), K(3), K(-3), K(1)}};
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      real3 sum = zero3();
      for (int y = 0; y <= j; ++y) {
        for (int x = 0; x <= i; ++x)
          sum = fma3(splat(binomial[j][y] * binomial[i][x]), p[y][x], sum);
      }
      put3(out, 4 * j + i, sum);
    }
  }
  for (int k = 0; k < 4; ++k)
    put3(out, QUAD_DIFFERENCE + k, mul3(splat(K(4.5f)), sub3(a[k], b[k])));
}
