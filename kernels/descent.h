// The descent to a foot within one patch, of one HIP or of as many as there are lanes: whole
// Newton steps, for as long as they are sound, stay inside and shorten the distance. What is not so
// is left to track.h.

// The account of a query: all that it has evaluated and walked, whichever of its searches did it.
typedef struct {
  int budget;       // evaluations after which no further descent begins; 0: no limit
  int evaluations;  // of patches
  int steps;        // those of them at feet: where descents begin, and each of their iterations
  int fan_steps;    // sides passed on the way round corners that very many share
  int fan_begin;    // these before the descent that goes on
  int is_cut;       // the budget has ended a search in a union (union.h), whose answer is unknown
} effort;

FN effort begin_effort(int budget) {
  effort r = {budget, 0, 0, 0, 0, 0};
  return r;
}

// A walk round a corner of more sides counts: as an evaluation for so many each. No descent begins
// one after so many.
#define WIDE_FAN 64
#define FAN_STEPS_AN_EVALUATION 16
#define FAN_STEPS_A_DESCENT 8192

// The evaluations that a query has spent, or the time of as many.
FN int evaluations_spent(const effort* spent) {
  return spent->evaluations + spent->fan_steps / FAN_STEPS_AN_EVALUATION;
}

// True if no further descent begins.
FN int is_spent(const effort* spent) {
  return spent->budget > 0 && evaluations_spent(spent) >= spent->budget;
}

typedef struct {
  int solver, max_iterations;
  scalar tolerance;  // length of the last step, local frame: relative to the size of the patch
  effort* spent;     // by all that have a copy of these options
} track_options;

// Symmetric 2 x 2 matrix.
typedef struct {
  real a, b, c;
} sym2;

typedef struct {
  real xi, eta;
} domain_vector;

FN domain_vector make_vector(real xi, real eta) {
  domain_vector r = {xi, eta};
  return r;
}

FN real quadratic(sym2 m, domain_vector v) {
  return fma(v.xi, fma(m.a, v.xi, K(2) * m.b * v.eta), m.c * v.eta * v.eta);
}

typedef struct {
  real xi, eta;
  patch_point at;       // local frame
  real3 r;              // SCP - HIP, local frame
  real distance2;       // squared, mesh frame
  sym2 curvature_term;  // estimate of the curvature term sum r . G_ij
  real last2;           // squared length of the last step, in the same patch; -1: there is none
  real before2;         // of the last whole step, in any patch
  real evaluations;     // after the first, but for those that were refused
  mask converged;
  mask refused;  // the last evaluation was no nearer: no step was taken
} descent;

// Makes it a descent that has taken no step.
FN void begin_descent(descent* d) {
  const real none = splat(K(0));
  d->last2 = d->before2 = splat(K(-1));
  d->evaluations = none;
  d->converged = d->refused = none > none;
}

// Goes on where the patch is evaluated; hip and unscale as the patch's frame has them.
FN void move_descent(descent* d, domain_vector x, patch_point at, real3 hip, real unscale) {
  d->xi = x.xi;
  d->eta = x.eta;
  d->at = at;
  d->r = sub3(at.g, hip);
  d->distance2 = dot3(d->r, d->r) * unscale * unscale;
}

FN domain_vector gradient_of(patch_point at, real3 r) {
  return make_vector(dot3(at.g_xi, r), dot3(at.g_eta, r));
}

FN sym2 first_form(patch_point at) {
  sym2 r = {dot3(at.g_xi, at.g_xi), dot3(at.g_xi, at.g_eta), dot3(at.g_eta, at.g_eta)};
  return r;
}

// The curvature term as the second fundamental form at the patch's centre has it.
FN sym2 curvature_term_of(patch_point at, real3 r, sym2 second, int solver) {
  const real3 normal = patch_normal(at);
  const real none = splat(K(0));
  const real depth =
      solver == SOLVER_NEWTON ? dot3(r, normal) / larger(norm3(normal), splat(TINY)) : none;
  sym2 s = {depth * second.a, depth * second.b, depth * second.c};
  return s;
}

typedef struct {
  sym2 m;
  real whole, det;  // of the first fundamental form, and of all
  real least;       // determinant, below which the parametrisation is singular
  mask is_sound;    // neither singular nor flat nor indefinite
} newton_model;

FN newton_model model_of(sym2 first, sym2 second) {
  newton_model r;
  r.m.a = first.a + second.a;
  r.m.b = first.b + second.b;
  r.m.c = first.c + second.c;
  r.whole = first.a * first.c - first.b * first.b;
  r.det = r.m.a * r.m.c - r.m.b * r.m.b;
  r.least = EPSILON * (first.a + first.c) * (first.a + first.c);
  r.is_sound =
      (r.det > K(0.0009765625f) * r.whole) & (r.m.a + r.m.c > splat(K(0))) & (r.det > r.least);
  return r;
}

// -m^-1 gradient
FN domain_vector solve(sym2 m, real det, domain_vector gradient) {
  const real inverse = K(-1) / det;
  return make_vector((m.c * gradient.xi - m.b * gradient.eta) * inverse,
                     (m.a * gradient.eta - m.b * gradient.xi) * inverse);
}

FN real outward(GLOBAL scalar* domain, int side, domain_vector step) {
  GLOBAL scalar* m = domain + DOMAIN_HEAD + DOMAIN_STRIDE * side;
  return fma(splat(m[0]), step.xi, splat(m[1]) * step.eta);
}

// A point no farther from a side lies on it.
FN scalar on_side_within(GLOBAL scalar* domain) {
  const scalar rounding = K(32) * EPSILON, share = (K(1) - domain[0]) / K(64);
  return rounding < share ? rounding : share;
}

// Steps shrink faster than linearly: what this one leaves is at most its square over the last. Then
// it is taken on the tangent plane, which saves an evaluation.
FN mask is_last(real length2, real last2, scalar tolerance) {
  const real zero = splat(K(0));
  return (last2 > zero) & (length2 * length2 <= tolerance * tolerance * last2) &
         (length2 <= splat(tolerance / K(64)));
}

// Near the minimum the distance no longer tells better from worse; steps that still shrink do.
FN mask is_at_rounding(domain_vector gradient, domain_vector step, real3 r) {
  const real fall = -fma(gradient.xi, step.xi, gradient.eta * step.eta);
  return fall <= K(16) * EPSILON * dot3(r, r);
}

// Secant update of the curvature term sum r . G_ij after a step, sized first, so that an estimate
// that was far too large does not linger (Dennis, Gay and Welsch 1981, section 3). Where the change
// v of the gradient says little of the step, `first` weighs instead, or the estimate would explode.
FN sym2 secant_update(sym2 s, sym2 first, domain_vector step, domain_vector y, domain_vector v) {
  const real size = quadratic(first, step), change = fma(v.xi, step.xi, v.eta * step.eta);
  const mask tells = change > size / K(8);
  const real vx = pick(tells, v.xi, fma(first.a, step.xi, first.b * step.eta)),
             vy = pick(tells, v.eta, fma(first.b, step.xi, first.c * step.eta));
  const real over = K(1) / pick(tells, change, size);
  const real seen = fabs(fma(step.xi, y.xi, step.eta * y.eta)), held = fabs(quadratic(s, step));
  const real sizing = pick(seen < held, seen / held, splat(K(1)));
  sym2 t = {s.a * sizing, s.b * sizing, s.c * sizing};
  const real ex = y.xi - fma(t.a, step.xi, t.b * step.eta),
             ey = y.eta - fma(t.b, step.xi, t.c * step.eta);
  const real es = fma(ex, step.xi, ey * step.eta) * over;
  const mask moved = size > splat(TINY);
  t.a = pick(moved, fma(over, K(2) * ex * vx - es * vx * vx, t.a), s.a);
  t.b = pick(moved, fma(over, ex * vy + ey * vx - es * vx * vy, t.b), s.b);
  t.c = pick(moved, fma(over, K(2) * ey * vy - es * vy * vy, t.c), s.c);
  return t;
}

// After a step from `at` to where the surface is `to` and r its distance.
FN sym2 curvature_term_after(sym2 curvature_term, patch_point at, domain_vector gradient,
                             domain_vector step, patch_point to, real3 r) {
  const domain_vector after = gradient_of(to, r), still = gradient_of(at, r);
  return secant_update(curvature_term, first_form(at), step,
                       make_vector(after.xi - still.xi, after.eta - still.eta),
                       make_vector(after.xi - gradient.xi, after.eta - gradient.eta));
}

FN descent pick_descent(mask m, descent a, descent b) {
  a.xi = pick(m, a.xi, b.xi);
  a.eta = pick(m, a.eta, b.eta);
  a.at.g = pick3(m, a.at.g, b.at.g);
  a.at.g_xi = pick3(m, a.at.g_xi, b.at.g_xi);
  a.at.g_eta = pick3(m, a.at.g_eta, b.at.g_eta);
  a.r = pick3(m, a.r, b.r);
  a.distance2 = pick(m, a.distance2, b.distance2);
  a.curvature_term.a = pick(m, a.curvature_term.a, b.curvature_term.a);
  a.curvature_term.b = pick(m, a.curvature_term.b, b.curvature_term.b);
  a.curvature_term.c = pick(m, a.curvature_term.c, b.curvature_term.c);
  a.last2 = pick(m, a.last2, b.last2);
  a.before2 = pick(m, a.before2, b.before2);
  a.evaluations = pick(m, a.evaluations, b.evaluations);
  a.converged = pick(m, a.converged, b.converged);
  return a;
}

// Copies number by number. What is copied as a whole GCC keeps in memory, not in registers, which
// costs a tick a third of the instructions of its descent.
FN void copy_descent(descent* to, const descent* from) {
  to->xi = from->xi;
  to->eta = from->eta;
  to->at.g = from->at.g;
  to->at.g_xi = from->at.g_xi;
  to->at.g_eta = from->at.g_eta;
  to->r = from->r;
  to->distance2 = from->distance2;
  to->curvature_term = from->curvature_term;
  to->last2 = from->last2;
  to->before2 = from->before2;
  to->evaluations = from->evaluations;
  to->converged = from->converged;
  to->refused = from->refused;
}

// Goes on from where a descent is; hip and unscale as the patch's frame has them.
FN void descend(GLOBAL scalar* domain, control_data control, uint form, int n, real3 hip,
                real unscale, track_options options, descent* at) {
  descent d;
  copy_descent(&d, at);
  const scalar tolerance2 = options.tolerance * options.tolerance, near = on_side_within(domain);
  const real most = splat((scalar)options.max_iterations), zero = splat(K(0));
  mask going = d.evaluations<most, refused = zero> zero;
  while (any(going)) {
    const domain_vector gradient = gradient_of(d.at, d.r);
    const sym2 first = first_form(d.at);
    const newton_model model = model_of(first, d.curvature_term);
    const domain_vector step = solve(model.m, model.det, gradient);
    const real length2 = quadratic(first, step);
    // A patch away the curvature is another.
    going = going & model.is_sound & (length2 <= splat(K(1)));
    for (int k = 0; k < n; ++k) {
      const real inside = side_distance(domain, n, k, d.xi, d.eta).f,
                 way = outward(domain, k, step);
      going = going & (inside > splat(near)) & (inside >= way);
    }
    const mask at_rounding = is_at_rounding(gradient, step, d.r);
    const mask ends = is_last(length2, d.last2, options.tolerance);
    const mask slides = going & ((length2 <= splat(tolerance2)) | ends);
    const mask stays = going & at_rounding & (d.before2 > zero) & (length2 >= d.before2);
    going = without(going, slides | stays);
    const domain_vector ahead = make_vector(d.xi + step.xi, d.eta + step.eta);
    descent next = d;
    if (any(slides)) {  // on the tangent plane
      const real3 move = fma3(step.xi, d.at.g_xi, mul3(step.eta, d.at.g_eta));
      descent slid = d;
      slid.xi = ahead.xi;
      slid.eta = ahead.eta;
      slid.at.g = add3(d.at.g, move);
      slid.r = add3(d.r, move);
      slid.distance2 = dot3(slid.r, slid.r) * unscale * unscale;
      d = pick_descent(slides, slid, d);
    }
    d.converged = d.converged | slides | stays;
    if (!any(going)) break;
    const domain_vector x = make_vector(pick(going, ahead.xi, d.xi), pick(going, ahead.eta, d.eta));
    move_descent(&next, x, evaluate_form(domain, control, form, n, x.xi, x.eta), hip, unscale);
    if (options.solver == SOLVER_NEWTON)
      next.curvature_term =
          curvature_term_after(d.curvature_term, d.at, gradient, step, next.at, next.r);
    next.last2 = next.before2 = length2;
    next.evaluations = d.evaluations + K(1);
    const mask fell = going & ((next.distance2 < d.distance2) | at_rounding);
    d = pick_descent(fell, next, d);
    refused = refused | without(going, fell);
    going = fell;
    going = going & (d.evaluations < most);
  }
  d.refused = refused;
  copy_descent(at, &d);
}
