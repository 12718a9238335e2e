// Sides with tangents of their own, and from a patch's exact control data to that of another form.
// On the host only, in scalars.

// Does as store_side does for a polygon with creases; `tangents` [n][2][3]. If the side before has
// tangents, T begins as it ends: with v_int (12) along -C'_prev(1), which is at right angles to the
// normal there, (11) has that direction whatever n_int is. In the same way T ends as the side after
// begins.
FN real store_crease_side(GLOBAL scalar* corners, GLOBAL scalar* tangents, int n, int k,
                          GLOBAL_OUT scalar* side) {
  const int before = wrap(k - 1, n), next = wrap(k + 1, n);
  const corner start = load_corner(corners, k), end = load_corner(corners, next);
  side_ends ends = side_ends_of(start, end);
  const crease_tangents own = load_tangents(tangents, k), back = load_tangents(tangents, before),
                        on = load_tangents(tangents, next);
  if (has_tangents(own)) {
    ends.ts = own.start;
    ends.te = own.end;
    ends.sound = smaller(norm3(ends.m0), norm3(ends.me));
  }
  side_data data = build_side(load_corner(corners, before), start, end,
                              load_corner(corners, wrap(next + 1, n)), ends);
  if (has_tangents(back)) {
    data.across[0] = mul3(K(-1), back.end);
    data.length[0] = norm3(back.end);
  }
  if (has_tangents(on)) {
    data.across[1] = on.start;
    data.length[1] = norm3(on.start);
  }
  return store_data(data, side);
}

// m(t) = m0 + t m1 of a side, eq. 10.
typedef struct {
  real3 m0, m1;
} side_lerp;

FN side_lerp lerp_of(GLOBAL scalar* corners, int n, int k) {
  const corner a = load_corner(corners, k), b = load_corner(corners, wrap(k + 1, n));
  const real3 e = unit3(sub3(b.p, a.p));
  const real3 m0 = cross3(a.n, e);
  const side_lerp r = {m0, sub3(cross3(b.n, e), m0)};
  return r;
}

// The same of a cross tangent at t.
FN ribbon_coefficients ribbon_coefficients_at(GLOBAL scalar* side, side_lerp m, real t,
                                              real3 tangent) {
  return ribbon_coefficients_of(tangent, cubic_at(side, SIDE_C, t).d, fma3(t, m.m1, m.m0));
}

// C''(t).
FN real3 second_at(GLOBAL scalar* side, real t) {
  return fma3(K(6) * t, load3(side, SIDE_C + 3), mul3(K(2), load3(side, SIDE_C + 2)));
}

// k, h and their derivatives at one end of a side, so that T and T' are those of the paper.
typedef struct {
  ribbon_coefficients f, d;
} ribbon_end;

FN ribbon_end ribbon_end_of(GLOBAL scalar* side, side_lerp m, real t, real3 tangent, real3 twist) {
  ribbon_end r;
  r.f = ribbon_coefficients_at(side, m, t, tangent);
  r.d = ribbon_coefficients_at(side, m, t,
                               fma3(-r.f.k, second_at(side, t), fma3(-r.f.h, m.m1, twist)));
  return r;
}

FN void to_ribbon(GLOBAL scalar* corners, GLOBAL scalar* exact, int n, GLOBAL_OUT scalar* out) {
  for (int k = 0; k < n; ++k) {
    GLOBAL scalar* from = exact + k * SIDE_REALS;
    GLOBAL_OUT scalar* to = out + k * RIBBON_REALS;
    for (int i = 0; i < 3 * (SIDE_TWIST_1 + 1); ++i) to[i] = from[i];
    const side_lerp m = lerp_of(corners, n, k);
    const ribbon_end a =
        ribbon_end_of(from, m, K(0), load3(from, SIDE_T_0), load3(from, SIDE_TWIST_0));
    const ribbon_end b =
        ribbon_end_of(from, m, K(1), load3(from, SIDE_T_1), load3(from, SIDE_TWIST_1));
    // k and h are the cubics of their ends plus a multiple of t^2 (1-t)^2.
    const real half = K(0.5f), eighth = K(0.125f);
    const ribbon_coefficients middle =
        ribbon_coefficients_at(from, m, half, side_at(from, half, half).t);
    const real k4 = K(16) * (middle.k - half * (a.f.k + b.f.k) - eighth * (a.d.k - b.d.k));
    const real h4 = K(16) * (middle.h - half * (a.f.h + b.f.h) - eighth * (a.d.h - b.d.h));
    // The cubics' coefficients, and those of t^4 and t^5 in their part of T.
    const real k2 = K(3) * (b.f.k - a.f.k) - K(2) * a.d.k - b.d.k;
    const real k3 = K(2) * (a.f.k - b.f.k) + a.d.k + b.d.k;
    const real h3 = K(2) * (a.f.h - b.f.h) + a.d.h + b.d.h;
    const real3 c0 = load3(from, SIDE_C + 1), c1 = mul3(K(2), load3(from, SIDE_C + 2)),
                c2 = mul3(K(3), load3(from, SIDE_C + 3));
    const real3 t4 = fma3(h3, m.m1, fma3(k3, c1, mul3(k2, c2))), t5 = mul3(k3, c2);
    store3(to + 3 * RIBBON_REST, 1, fma3(k4, c0, fma3(h4, m.m0, fma3(K(2), t5, t4))));
    store3(to + 3 * RIBBON_REST + 3, 1, fma3(k4, c1, fma3(h4, m.m1, t5)));
    store3(to + 3 * RIBBON_REST + 6, 1, mul3(k4, c2));
  }
}

FN bezier_side bezier_side_of(GLOBAL scalar* corners, GLOBAL scalar* exact, int n, int side) {
  GLOBAL scalar* from = exact + side * SIDE_REALS;
  const side_lerp m = lerp_of(corners, n, side);
  const real half = K(0.5f);
  const ribbon_coefficients a = ribbon_coefficients_at(from, m, K(0), load3(from, SIDE_T_0)),
                            b = ribbon_coefficients_at(from, m, K(1), load3(from, SIDE_T_1)),
                            middle =
                                ribbon_coefficients_at(from, m, half, side_at(from, half, half).t);
  const real k1 = b.k - a.k;
  const real h1 = K(4) * middle.h - K(3) * a.h - b.h, h2 = K(2) * (a.h + b.h) - K(4) * middle.h;
  bezier_side r;
  for (int i = 0; i < 4; ++i) r.c[i] = load3(from, SIDE_C + i);
  const real3 c0 = r.c[1], c1 = mul3(K(2), r.c[2]), c2 = mul3(K(3), r.c[3]);
  r.t[0] = fma3(a.k, c0, mul3(a.h, m.m0));
  r.t[1] = fma3(a.k, c1, fma3(k1, c0, fma3(a.h, m.m1, mul3(h1, m.m0))));
  r.t[2] = fma3(a.k, c2, fma3(k1, c1, fma3(h1, m.m1, mul3(h2, m.m0))));
  r.t[3] = fma3(k1, c2, mul3(h2, m.m1));
  to_bezier(r.c);
  to_bezier(r.t);
  return r;
}

FN void to_gregory_quad(GLOBAL scalar* corners, GLOBAL scalar* exact, GLOBAL_OUT scalar* out) {
  bezier_side s[4];
  for (int k = 0; k < 4; ++k) s[k] = bezier_side_of(corners, exact, 4, k);
  store_quad(s, out);
}

// Adds f times a^i b^j (1 - a - b)^k to polynomials of degree 3 in a and b, [j][i].
FN void add_power(real3 to[4][4], int i, int j, int k, real3 f) {
  const int factorial[4] = {1, 1, 2, 6};
  for (int x = 0; x <= k; ++x) {
    for (int y = 0; x + y <= k; ++y) {
      const int count = factorial[k] / (factorial[x] * factorial[y] * factorial[k - x - y]);
      to[j + y][i + x] = fma3(K((x + y) % 2 == 0 ? count : -count), f, to[j + y][i + x]);
    }
  }
}

FN void to_gregory_triangle(GLOBAL scalar* corners, GLOBAL scalar* exact, GLOBAL_OUT scalar* out) {
  const real half = K(0.5f), quarter = K(0.25f);
  bezier_side s[3];
  for (int k = 0; k < 3; ++k) s[k] = bezier_side_of(corners, exact, 3, k);
  // Inner point at the start and at the end of side k: the quartic boundary's, and a quarter of the
  // derivative towards the corner opposite to its start, which is T + t C'.
  real3 at_start[3], at_end[3];
  for (int k = 0; k < 3; ++k) {
    at_start[k] = fma3(quarter, s[k].t[1], s[k].c[1]);
    at_end[k] = fma3(quarter, s[k].t[2], s[k].c[2]);
  }
  const real3 *a = at_start, b[3] = {at_end[2], at_end[0], at_end[1]};
  // A cubic with the boundary's points, whose inner point gives corner 2 its mean.
  const real3 before[3] = {s[2].c[2], s[0].c[2], s[1].c[2]},
              after[3] = {s[0].c[1], s[1].c[1], s[2].c[1]};
  const real3 mean2 = mul3(half, add3(a[2], b[2]));
  const real3 inner = fma3(K(2), mean2, mul3(-half, add3(before[2], after[2])));
  real3 f[4][4];
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) f[j][i] = mul3(K(0), inner);
  }
  for (int k = 0; k < 3; ++k) {  // side k has powers of corner k's and the next one's coordinates
    for (int i = 0; i < 3; ++i) {
      int power[3] = {0, 0, 0};
      power[k] = 3 - i;
      power[(k + 1) % 3] = i;
      add_power(f, power[0], power[1], power[2], mul3(i == 0 ? K(1) : K(3), s[k].c[i]));
    }
  }
  add_power(f, 1, 1, 1, mul3(K(6), inner));
  int next = 0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i + j < 4; ++i) store3(out + 3 * next++, 1, f[j][i]);
  }
  for (int k = 0; k < 3; ++k) {
    const real3 elevated = mul3(quarter, fma3(K(2), inner, add3(before[k], after[k])));
    const real3 mean = mul3(half, add3(a[k], b[k]));
    if (k < 2) store3(out + 3 * (TRIANGLE_INNER + k), 1, mul3(K(12), sub3(mean, elevated)));
    store3(out + 3 * (TRIANGLE_DIFFERENCE + k), 1, mul3(K(6), sub3(a[k], b[k])));
  }
}

// Tables are made a row of nodes at a time, row j of corner k, from samples of the patch in lanes.
// A node has three: at it, and at two places beside it, for G_uv is a difference of G_u along v,
// inwards at the corner's sides; at the corner itself, where it depends on the direction, the mean
// of those along both sides.
#define TABLE_ROW_SAMPLES(r) (3 * ((r) + 1))  // those of a kind together
#define TABLE_STEP K(0x1p-12f)

// Puts the place of (u, v) of corner k into rows of xi and eta.
FN void store_place(GLOBAL scalar* domain, int n, int k, real u, real v, GLOBAL_OUT scalar* at,
                    int stride) {
  // u (d_(k-1) + d_(k+1)) = d_(k-1) and v (d_k + d_(k-2)) = d_k: two lines.
  GLOBAL scalar* side = domain + DOMAIN_HEAD;
  GLOBAL scalar *a = side + DOMAIN_STRIDE * wrap(k - 1, n),
                *b = side + DOMAIN_STRIDE * wrap(k + 1, n), *c = side + DOMAIN_STRIDE * k,
                *d = side + DOMAIN_STRIDE * wrap(wrap(k - 1, n) - 1, n);
  const real px = (K(1) - u) * a[0] - u * b[0], py = (K(1) - u) * a[1] - u * b[1];
  const real qx = (K(1) - v) * c[0] - v * d[0], qy = (K(1) - v) * c[1] - v * d[1];
  const real p = (K(1) - K(2) * u) * domain[0], q = (K(1) - K(2) * v) * domain[0];
  const real over = K(1) / (px * qy - py * qx);
  at[0] = (p * qy - q * py) * over;
  at[stride] = (px * q - qx * p) * over;
}

FN void store_row_places(GLOBAL scalar* domain, int n, int r, int k, int j, GLOBAL_OUT scalar* at) {
  const int stride = TABLE_ROW_SAMPLES(r);
  const real h = K(1) / K(2 * r), step = TABLE_STEP, v = h * K(j);
  for (int i = 0; i <= r; ++i) {
    const real u = h * K(i);
    GLOBAL_OUT scalar *a = at + (r + 1) + i, *b = a + (r + 1);
    store_place(domain, n, k, u, v, at + i, stride);
    if (j > 0) {
      store_place(domain, n, k, u, v + step, a, stride);
      store_place(domain, n, k, u, v - step, b, stride);
    } else if (i > 0) {
      store_place(domain, n, k, u + step, v, a, stride);
      store_place(domain, n, k, u - step, v, b, stride);
    } else {
      store_place(domain, n, k, step, v, a, stride);
      store_place(domain, n, k, u, step, b, stride);
    }
  }
}

// G_u and G_v of a patch at a place of corner k.
typedef struct {
  real3 g, u, v;
} table_sample;

// `rows`: what the patch is at the places (store_point).
FN table_sample sample_at(GLOBAL scalar* domain, int n, int k, GLOBAL scalar* at,
                          GLOBAL scalar* rows, int stride) {
  const real xi = at[0], eta = at[stride];
  const jet ju = corner_u(domain, n, k, xi, eta).u,
            jv = corner_u(domain, n, wrap(k - 1, n), xi, eta).rest;
  const real inverse = K(1) / (ju.xi * jv.eta - ju.eta * jv.xi);
  const real3 g_xi = make3(rows[3 * stride], rows[4 * stride], rows[5 * stride]),
              g_eta = make3(rows[6 * stride], rows[7 * stride], rows[8 * stride]);
  table_sample r;
  r.g = make3(rows[0], rows[stride], rows[2 * stride]);
  r.u = mul3(inverse, fma3(jv.eta, g_xi, mul3(-jv.xi, g_eta)));
  r.v = mul3(inverse, fma3(-ju.eta, g_xi, mul3(ju.xi, g_eta)));
  return r;
}

FN void store_row(GLOBAL scalar* domain, int n, int r, int k, int j, GLOBAL scalar* at,
                  GLOBAL scalar* rows, GLOBAL_OUT scalar* out) {
  const int stride = TABLE_ROW_SAMPLES(r);
  const real h = K(1) / K(2 * r), over = K(0.5f) / TABLE_STEP;
  for (int i = 0; i <= r; ++i) {
    const int first = r + 1 + i, second = first + r + 1;
    const table_sample here = sample_at(domain, n, k, at + i, rows + i, stride),
                       a = sample_at(domain, n, k, at + first, rows + first, stride),
                       b = sample_at(domain, n, k, at + second, rows + second, stride);
    const real3 apart = j > 0   ? sub3(a.u, b.u)
                        : i > 0 ? sub3(a.v, b.v)
                                // A and B of eq. 2
                                : add3(sub3(a.v, here.v), sub3(b.u, here.u));
    GLOBAL_OUT scalar* node = out + NODE_SAMPLES * ((k * (r + 1) + j) * (r + 1) + i);
    store3(node, 1, here.g);
    store3(node + 3, 1, mul3(h, here.u));
    store3(node + 6, 1, mul3(h, here.v));
    store3(node + 9, 1, mul3(h * h, mul3(over, apart)));
  }
}

// Numbers of a patch's control data in a form (with r << 8 for a table).
FN ulong control_reals(uint form, uint n) {
  const uint kind = form & 255u, r = form >> 8;
  return (ulong)n * (kind == FORM_PAPER    ? (uint)SIDE_REALS
                     : kind == FORM_RIBBON ? RIBBON_REALS
                     : kind == FORM_BEZIER ? BEZIER_REALS
                     : kind == FORM_SEXTIC ? SEXTIC_REALS
                     : kind == FORM_CURVED ? CURVED_REALS
                                           : TABLE_REALS(r));
}

// `form`: ribbon, or bezier of 3 or 4 sides.
FN void to_form(GLOBAL scalar* corners, GLOBAL scalar* exact, uint form, int n,
                GLOBAL_OUT scalar* out) {
  if (form == FORM_RIBBON) {
    to_ribbon(corners, exact, n, out);
  } else if (n == 4) {
    to_gregory_quad(corners, exact, out);
  } else {
    to_gregory_triangle(corners, exact, out);
  }
}
