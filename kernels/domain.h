// The parametric domain: a regular n-gon in the unit circle (Figure 4), the corner parameters u_k
// of eq. 3 and the weights of eq. 5. Both are written as jets: a value with its derivatives along
// xi and eta.

typedef struct {
  real f, xi, eta;
} jet;

FN jet make_jet(real f, real xi, real eta) {
  jet r = {f, xi, eta};
  return r;
}
FN jet mul_jet(jet a, jet b) {
  return make_jet(a.f * b.f, fma(a.f, b.xi, a.xi * b.f), fma(a.f, b.eta, a.eta * b.f));
}
FN jet add_jet(jet a, jet b) { return make_jet(a.f + b.f, a.xi + b.xi, a.eta + b.eta); }

// Numbers of the table of a valence (layout.h), made on the host.
#define DOMAIN_REALS(n) (DOMAIN_HEAD + DOMAIN_STRIDE * (n))
// From this valence on, distances are compensated: u loses n^2 roundings of d.
#define DOMAIN_COMPENSATED 32

FN int wrap(int k, int n) { return k < 0 ? k + n : k >= n ? k - n : k; }

// Distance d_k to side k, never negative, with the derivative of the unclamped distance.
FN jet side_distance(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  GLOBAL scalar* m = domain + DOMAIN_HEAD + DOMAIN_STRIDE * k;
  const real mx = splat(m[0]), my = splat(m[1]);
  real d;
  if (n < DOMAIN_COMPENSATED) {
    d = fma(-xi, mx, fma(-eta, my, splat(domain[0])));
  } else {  // exact products and sums, rounded once (Dekker)
    const real p = xi * mx, q = eta * my, c = splat(domain[0]);
    const real s = p + q, t = c - s;
    const real s_low = (p - (s - (s - p))) + (q - (s - p));
    const real t_low = (c - (t + (c - t))) - (s - (c - t));
    const real low = fma(xi, mx, -p) + fma(eta, my, -q) + xi * splat(m[2]) + eta * splat(m[3]);
    d = t + (t_low - s_low - low + splat(domain[1]));
  }
  return make_jet(larger(d, splat(K(0))), -mx, -my);
}

// u_k = d_(k-1) / (d_(k-1) + d_(k+1)), eq. 3; and what is left of 1, v_(k+1).
typedef struct {
  jet u, rest;
} corner_parameter;

FN corner_parameter corner_u(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  const jet a = side_distance(domain, n, wrap(k - 1, n), xi, eta);
  const jet b = side_distance(domain, n, wrap(k + 1, n), xi, eta);
  const real inverse = K(1) / larger(a.f + b.f, splat(TINY));
  const real u = a.f * inverse, v = b.f * inverse;
  const real along_xi = (v * a.xi - u * b.xi) * inverse,
             along_eta = (v * a.eta - u * b.eta) * inverse;
  corner_parameter r;
  r.u = make_jet(u, along_xi, along_eta);
  r.rest = make_jet(v, -along_xi, -along_eta);
  return r;
}

// The two smallest distances and their sides: what the weights are measured against.
typedef struct {
  real s, t;  // indices of the sides, as numbers, so that lanes may differ
  jet d_s, d_t;
} near_sides;

FN jet pick_jet_if_less(real a, real b, jet yes, jet no) {
  return make_jet(pick(a < b, yes.f, no.f), pick(a < b, yes.xi, no.xi),
                  pick(a < b, yes.eta, no.eta));
}

FN near_sides find_near_sides(GLOBAL scalar* domain, int n, real xi, real eta) {
  near_sides r;
  r.s = splat(K(0));
  r.t = splat(K(-1));
  r.d_s = side_distance(domain, n, 0, xi, eta);
  r.d_t = make_jet(splat(K(4)), splat(K(0)), splat(K(0)));  // farther than any side
  UNROLL
  for (int k = 1; k < n; ++k) {
    const jet d = side_distance(domain, n, k, xi, eta);
    const real here = splat((scalar)k);
    const real f = d.f, s = r.d_s.f, t = r.d_t.f;
    r.t = pick(f < s, r.s, pick(f < t, here, r.t));
    r.d_t = pick_jet_if_less(f, s, r.d_s, pick_jet_if_less(f, t, d, r.d_t));
    r.s = pick(f < s, here, r.s);
    r.d_s = pick_jet_if_less(f, s, d, r.d_s);
  }
  return r;
}

// Weight of corner k, eq. 5, up to a factor common to all k: the product as printed, for the few
// factors of a small n.
#define DOMAIN_PRODUCTS 6
FN jet corner_product(GLOBAL scalar* domain, int n, int k, real xi, real eta) {
  jet p = side_distance(domain, n, wrap(k + 1, n), xi, eta);
  UNROLL
  for (int i = 2; i < n - 1; ++i) {
    p = mul_jet(p, side_distance(domain, n, wrap(k + i, n), xi, eta));
  }
  const real twice = K(2) * p.f;
  return make_jet(p.f * p.f, twice * p.xi, twice * p.eta);
}

// The same for any n:
//   w_k ~ rho^2, rho = d_s d_t / (d_(k-1) d_k), each of s and t cancelled where it is k-1 or k.
// 0 <= rho <= 1 and no quotient is 0/0: products of d_j^2 as printed underflow in float from n
// = 64.
FN jet corner_quotient(GLOBAL scalar* domain, int n, int k, near_sides near, real xi, real eta) {
  const jet one = make_jet(splat(K(1)), splat(K(0)), splat(K(0)));
  const int before = wrap(k - 1, n);
  const real i = splat((scalar)before), j = splat((scalar)k), zero = splat(K(0));
  // |(s - i)(s - j)| is 0 where s is one of the corner's sides, else at least 1.
  const real s_here = (near.s - i) * (near.s - j) * (near.s - i) * (near.s - j);
  const real t_here = (near.t - i) * (near.t - j) * (near.t - i) * (near.t - j);
  const real a_near = (near.s - i) * (near.t - i) * (near.s - i) * (near.t - i);
  const real b_near = (near.s - j) * (near.t - j) * (near.s - j) * (near.t - j);
  const jet over = mul_jet(pick_jet_if_less(zero, s_here, near.d_s, one),
                           pick_jet_if_less(zero, t_here, near.d_t, one));
  const jet under =
      mul_jet(pick_jet_if_less(zero, a_near, side_distance(domain, n, before, xi, eta), one),
              pick_jet_if_less(zero, b_near, side_distance(domain, n, k, xi, eta), one));
  const real inverse = K(1) / under.f;
  const real rho = over.f * inverse;
  const real twice = K(2) * rho * inverse;
  return make_jet(rho * rho, twice * fma(-rho, under.xi, over.xi),
                  twice * fma(-rho, under.eta, over.eta));
}

FN jet corner_weight(GLOBAL scalar* domain, int n, int k, near_sides near, real xi, real eta) {
  return n <= DOMAIN_PRODUCTS ? corner_product(domain, n, k, xi, eta)
                              : corner_quotient(domain, n, k, near, xi, eta);
}
