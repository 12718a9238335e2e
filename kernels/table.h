// A patch as samples: each corner's part of the domain, to the centre and the middles of its two
// sides, is the square [0, 1/2]^2 of its parameters u and v (eq. 3), cut into r x r cells that
// interpolate their nodes by bicubic Hermite polynomials. Boundary curves are cubic, so they are
// kept; boundary normals are not.

// A node: G and h G_u, h G_v, h^2 G_uv, where h = 1 / (2 r) is a cell's width.
#define NODE_SAMPLES 12
#define TABLE_REALS(r) (NODE_SAMPLES * ((r) + 1) * ((r) + 1))  // of a corner: [v][u]

// Along u between two nodes that are neighbours; `triple` 0: G, 2: its slope along v.
FN curve_point hermite_row(const real* nodes, int triple, hermite_basis u) {
  const real *at = nodes + 3 * triple, *next = at + NODE_SAMPLES;
  const real3 f0 = make3(at[0], at[1], at[2]), d0 = make3(at[3], at[4], at[5]),
              f1 = make3(next[0], next[1], next[2]), d1 = make3(next[3], next[4], next[5]);
  curve_point r;
  r.f = fma3(u.g1, d1, fma3(u.g0, d0, fma3(u.h1, f1, mul3(u.h0, f0))));
  r.d = fma3(u.dg1, d1, fma3(u.dg0, d0, fma3(u.dh1, f1, mul3(u.dh0, f0))));
  return r;
}

FN patch_point evaluate_table(GLOBAL scalar* domain, GLOBAL scalar* control, int r, int n, real xi,
                              real eta) {
  // The nearest corner, and the point as if that were corner 0.
  GLOBAL scalar* corners = domain + DOMAIN_HEAD + DOMAIN_CORNER;
  real k = splat(K(0)), cx = splat(corners[0]), cy = splat(corners[1]);
  real x = fma(cx, xi, cy * eta);
  for (int i = 1; i < n; ++i) {
    GLOBAL scalar* c = corners + DOMAIN_STRIDE * i;
    const real along = fma(splat(c[0]), xi, splat(c[1]) * eta);
    k = pick(along > x, splat((scalar)i), k);
    cx = pick(along > x, splat(c[0]), cx);
    cy = pick(along > x, splat(c[1]), cy);
    x = larger(along, x);
  }
  const real y = fma(cx, eta, -cy * xi);
  const jet u = corner_u(domain, n, 0, x, y).u, v = corner_u(domain, n, n - 1, x, y).rest;
  const real zero = splat(K(0)), cells = splat((scalar)(2 * r)), last = splat((scalar)(r - 1));
  const real i = smaller(larger(whole_part(cells * u.f), zero), last),
             j = smaller(larger(whole_part(cells * v.f), zero), last);
  const hermite_basis s = hermite_at(fma(cells, u.f, -i)), t = hermite_at(fma(cells, v.f, -j));
  const real width = splat((scalar)(r + 1));
  const real index = splat(K(NODE_SAMPLES)) * fma(fma(k, width, j), width, i);
  real below[2 * NODE_SAMPLES], above[2 * NODE_SAMPLES];
  gather_columns(control, index, 2 * NODE_SAMPLES, below);
  gather_columns(control + NODE_SAMPLES * (r + 1), index, 2 * NODE_SAMPLES, above);
  const curve_point f0 = hermite_row(below, 0, s), f1 = hermite_row(above, 0, s),
                    d0 = hermite_row(below, 2, s), d1 = hermite_row(above, 2, s);
  patch_point p;
  p.g = fma3(t.g1, d1.f, fma3(t.g0, d0.f, fma3(t.h1, f1.f, mul3(t.h0, f0.f))));
  const real3 g_u =
      mul3(cells, fma3(t.g1, d1.d, fma3(t.g0, d0.d, fma3(t.h1, f1.d, mul3(t.h0, f0.d)))));
  const real3 g_v =
      mul3(cells, fma3(t.dg1, d1.f, fma3(t.dg0, d0.f, fma3(t.dh1, f1.f, mul3(t.dh0, f0.f)))));
  const real3 g_x = fma3(v.xi, g_v, mul3(u.xi, g_u)), g_y = fma3(v.eta, g_v, mul3(u.eta, g_u));
  p.g_xi = fma3(-cy, g_y, mul3(cx, g_x));
  p.g_eta = fma3(cx, g_y, mul3(cy, g_x));
  return p;
}
