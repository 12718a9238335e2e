// The surface contact point: the nearest point of the surface to the HIP, found from a start by
// steps in the domain that never increase the distance, over edges where the neighbour is nearer
// (4.2, 4.3).

typedef struct {
  uint patch;
  real xi, eta;
} domain_point;

typedef struct {
  uint patch;
  descent d;
  real clear2;    // squared, mesh frame: no point of the surface is nearer, as far as is known
  int crossings;  // edges and corners crossed
  uint flags;     // FOOT_*, but for FOOT_CONVERGED
  real entered2;  // distance2 where it came over a sharp edge last; below 0: it did not
} foot;

// Evaluates a patch at a foot, and elsewhere for what a step of it needs to know.
FN patch_point evaluate_step(surface_view view, domain_point at, effort* spent) {
  ++spent->evaluations;
  ++spent->steps;
  return evaluate_patch(view, at.patch, at.xi, at.eta);
}
FN patch_point evaluate_aside(surface_view view, domain_point at, effort* spent) {
  ++spent->evaluations;
  return evaluate_patch(view, at.patch, at.xi, at.eta);
}

FN foot move_foot(surface_view view, hip_point h, foot f, domain_point at, effort* spent) {
  f.patch = at.patch;
  move_descent(&f.d, make_vector(at.xi, at.eta), evaluate_step(view, at, spent),
               local_hip(view, h, at.patch), numbers_of(view, at.patch)[PATCH_UNSCALE]);
  return f;
}

// Makes it a foot that nothing is known of but its descent.
FN void begin_foot_of(foot* f, uint patch) {
  f->patch = patch;
  f->clear2 = K(0);
  f->crossings = 0;
  f->flags = 0u;
  f->entered2 = -K(1);
}

FN foot start_foot(surface_view view, hip_point h, domain_point at, effort* spent) {
  foot f;
  begin_foot_of(&f, at.patch);
  begin_descent(&f.d);
  spent->fan_begin = spent->fan_steps;
  return move_foot(view, h, f, at, spent);
}

// Sides on which a domain point lies: none (-1), one (a), or the two at corner b.
typedef struct {
  int a, b;
} held_sides;

FN held_sides sides_at(GLOBAL scalar* domain, int n, real xi, real eta) {
  held_sides r = {-1, -1};
  const real near = on_side_within(domain);
  for (int k = 0; k < n; ++k) {
    if (side_distance(domain, n, k, xi, eta).f > near) continue;
    if (r.a < 0) {
      r.a = k;
    } else if (wrap(r.a + 1, n) == k) {
      r.b = k;
    } else if (wrap(k + 1, n) == r.a) {
      r.b = r.a;
      r.a = k;
    }
  }
  return r;
}

FN domain_vector domain_corner(GLOBAL scalar* domain, int k) {
  GLOBAL scalar* c = domain + DOMAIN_HEAD + DOMAIN_STRIDE * k + DOMAIN_CORNER;
  return make_vector(c[0], c[1]);
}

// Eq. 15: the point of side `twin` at the same ratio as (xi, eta) on its own side, which runs the
// other way.
FN domain_point cross_edge(surface_view view, uint side, uint twin, real xi, real eta) {
  const uint from = view.side_patch[side];
  const int n = valence_of(view, from), k = (int)(side - view.side_begin[from]);
  const domain_vector c = domain_corner(domain_of(view, n), k),
                      e = domain_corner(domain_of(view, n), wrap(k + 1, n));
  const real dx = e.xi - c.xi, dy = e.eta - c.eta;
  real t = fma(xi - c.xi, dx, (eta - c.eta) * dy) / fma(dx, dx, dy * dy);
  t = smaller(larger(t, K(0)), K(1));
  domain_point r;
  r.patch = view.side_patch[twin];
  const int m = valence_of(view, r.patch), i = (int)(twin - view.side_begin[r.patch]);
  const domain_vector start = domain_corner(domain_of(view, m), i),
                      end = domain_corner(domain_of(view, m), wrap(i + 1, m));
  r.xi = fma(t, start.xi - end.xi, end.xi);
  r.eta = fma(t, start.eta - end.eta, end.eta);
  return r;
}

FN uint next_in_patch(surface_view view, uint side) {
  const uint patch = view.side_patch[side];
  return side + 1 == view.side_begin[patch + 1] ? view.side_begin[patch] : side + 1;
}
FN uint prev_in_patch(surface_view view, uint side) {
  const uint patch = view.side_patch[side];
  return side == view.side_begin[patch] ? view.side_begin[patch + 1] - 1 : side - 1;
}

// Tangents at the corner where a side starts: along it, and along the side that ends there,
// backwards. Lengths do not matter.
typedef struct {
  real3 p, q;
  int are_slopes;  // of the patch there: the shorter has the rounding of the longer
} corner_tangents;

FN corner_tangents tangents_at(surface_view view, uint side, effort* spent) {
  const uint patch = view.side_patch[side], form = view.form[patch];
  const int n = valence_of(view, patch), k = (int)(side - view.side_begin[patch]);
  GLOBAL scalar* control = control_of(view, patch);
  corner_tangents r;
  r.are_slopes = !(IS_FORM(form, FORM_PAPER) || IS_FORM(form, FORM_RIBBON));
  if (!r.are_slopes) {
    GLOBAL scalar* own = control + k * side_reals(form);
    r.p = load3(own, SIDE_C + 1);
    r.q = load3(own, SIDE_T_0);
  } else if (IS_FORM(form, FORM_CURVED)) {
    GLOBAL scalar* own = control + k * CURVED_REALS;
    GLOBAL scalar* before = control + wrap(k - 1, n) * CURVED_REALS;
    r.p = sub3(load3(own, CURVED_C + 1), load3(own, CURVED_C));
    r.q = sub3(load3(before, CURVED_C + 2), load3(before, CURVED_C + 3));
  } else if (IS_FORM(form, FORM_SEXTIC)) {
    r.p = sub3(sextic_boundary(control, k, 1), sextic_boundary(control, k, 0));
    r.q = sub3(sextic_boundary(control, wrap(k - 1, 3), 5), sextic_boundary(control, k, 0));
  } else {
    GLOBAL scalar* domain = domain_of(view, n);
    const domain_vector at = domain_corner(domain, k), a = domain_corner(domain, wrap(k + 1, n)),
                        b = domain_corner(domain, wrap(k - 1, n));
    const domain_point corner = {patch, at.xi, at.eta};
    const patch_point g = evaluate_aside(view, corner, spent);
    r.p = fma3(a.xi - at.xi, g.g_xi, mul3(a.eta - at.eta, g.g_eta));
    r.q = fma3(b.xi - at.xi, g.g_xi, mul3(b.eta - at.eta, g.g_eta));
  }
  return r;
}

// True if the direction w, seen from the corner where `side` starts, points into the side's patch.
FN int in_sector(surface_view view, uint side, real3 w, effort* spent) {
  const corner_tangents t = tangents_at(view, side, spent);
  const real3 p = t.p, q = t.q;
  const real pp = dot3(p, p), pq = dot3(p, q), qq = dot3(q, q), wp = dot3(w, p), wq = dot3(w, q);
  const real a = wp * qq - wq * pq, b = wq * pp - wp * pq;
  // Along an edge rounding leaves no gap between the patches on its sides.
  const real gap = K(-16) * EPSILON * norm3(w),
             size2 = t.are_slopes ? larger(pp, qq) : sqrt(pp * qq);
  return a >= gap * size2 * sqrt(qq) && b >= gap * size2 * sqrt(pp) && a + b > K(0);
}

// A walk over the other sides that start where `start` does: anticlockwise, and where a border cuts
// that short, clockwise from `start` on.
typedef struct {
  uint start, at;
  int met_border;
} fan_walk;

FN fan_walk start_fan(uint side) {
  fan_walk r = {side, side, 0};
  return r;
}

// The next side; NONE after the last.
FN uint next_in_fan(surface_view view, fan_walk* w) {
  if (!w->met_border) {
    w->at = view.side_twin[prev_in_patch(view, w->at)];
    if (w->at == w->start) return NONE;
    if (w->at != NONE) return w->at;
    w->met_border = 1;
    w->at = w->start;
  }
  w->at = view.side_twin[w->at];
  if (w->at != NONE) w->at = next_in_patch(view, w->at);
  return w->at;
}

// The side that starts at a corner's vertex and whose patch a direction points into, and its way;
// NONE if there is none but its own.
typedef struct {
  uint side;
  int is_border;  // of NONE: a border runs through the vertex
} fan_place;

FN_LARGE fan_place find_in_fan(surface_view view, uint side, real3 w, effort* spent) {
  fan_place r = {NONE, 0};
  fan_walk fan = start_fan(side);
  int steps = 0;
  for (r.side = next_in_fan(view, &fan); r.side != NONE; r.side = next_in_fan(view, &fan)) {
    ++steps;
    if (in_sector(view, r.side, w, spent)) break;
  }
  spent->fan_steps += steps > WIDE_FAN ? steps : 0;
  r.is_border = fan.met_border;
  return r;
}

// Finds the border or sharp edge at a vertex that goes most along w, and returns the side there
// whose patch has it. From a corner a way may point into no patch and yet lead along an edge of
// another patch than that of `side`. Returns NONE if no such edge follows w, or if one of the two
// edges of that patch already does.
FN_LARGE uint edge_in_fan(surface_view view, uint side, real3 w, effort* spent) {
  uint best = NONE;
  real most = K(16) * EPSILON * norm3(w);
  fan_walk fan = start_fan(side);
  for (uint at = side; at != NONE; at = next_in_fan(view, &fan)) {
    const corner_tangents t = tangents_at(view, at, spent);
    const real forth = dot3(t.p, w) / larger(norm3(t.p), TINY),
               back = dot3(t.q, w) / larger(norm3(t.q), TINY);
    if (forth > most && !is_smooth_side(view, at)) {
      most = forth;
      best = at;
    }
    if (back > most && view.side_twin[prev_in_patch(view, at)] == NONE) {
      most = back;
      best = at;
    }
  }
  if (best == NONE) return NONE;
  const corner_tangents own = tangents_at(view, side, spent);
  return dot3(own.p, w) > K(0) || dot3(own.q, w) > K(0) ? NONE : best;
}

// True if a border runs through the vertex at which `side` starts.
FN int is_border_vertex(surface_view view, uint side) {
  fan_walk fan = start_fan(side);
  while (!fan.met_border && next_in_fan(view, &fan) != NONE) continue;
  return fan.met_border;
}

// The step where first + second is flat or indefinite: of its curvatures relative to `first`, those
// that rise are kept, so that flat minima are not crept to; 1 stands for the others, as in the
// Gauss-Newton step. Their own size in its stead makes no search shorter, nor longer.
FN domain_vector saddle_step(sym2 first, sym2 second, domain_vector gradient) {
  // first = L L^T; of L^-1 second L^-T the eigenvalues, and 1 more those of the whole.
  const real l = sqrt(first.a), m = first.b / l;
  const real k = sqrt(larger(first.c - m * m, TINY));
  const real a = second.a / (l * l), b = (second.b / l - a * m) / k,
             c = (second.c - m * (K(2) * second.b / l - a * m)) / (k * k);
  const real mean = K(1) + (a + c) / K(2), half_gap = (a - c) / K(2);
  const real apart = sqrt(fma(half_gap, half_gap, b * b));
  const real least = K(0x1p-20f);
  const real high = mean + apart > least ? mean + apart : K(1),
             low = mean - apart > least ? mean - apart : K(1);
  // 1 / |.| of a matrix is mix + slope times it.
  const real slope = apart > TINY ? (K(1) / high - K(1) / low) / (K(2) * apart) : K(0);
  const real mix = (K(1) / high + K(1) / low) / K(2);
  const real x = gradient.xi / l, y = (gradient.eta - m * x) / k;
  const real p = fma(mix, x, slope * fma(half_gap, x, b * y)),
             q = fma(mix, y, slope * fma(b, x, -half_gap * y));
  const real eta = -q / k;
  return make_vector((-p - m * eta) / l, eta);
}

// -model^-1 gradient; damped where the parametrisation is singular.
FN domain_vector newton_step(sym2 first, sym2 second, domain_vector gradient) {
  newton_model model = model_of(first, second);
  if (model.is_sound) return solve(model.m, model.det, gradient);
  if (model.whole > model.least) return saddle_step(first, second, gradient);
  const real damp = K(0.0009765625f) * (first.a + first.c) + TINY;
  sym2 m = first;
  m.a += damp;
  m.c += damp;
  return solve(m, m.a * m.c - m.b * m.b, gradient);
}

// Best step along a side that holds the point, away from the corner where there is one; (0, 0) if
// none descends.
FN domain_vector edge_step(GLOBAL scalar* domain, int n, held_sides held, sym2 first,
                           sym2 curvature_term, domain_vector gradient) {
  domain_vector best = make_vector(K(0), K(0));
  real gain = K(0);
  for (int which = 0; which < 2; ++which) {
    const int k = which == 0 ? held.a : held.b;
    if (k < 0) continue;
    const domain_vector c = domain_corner(domain, k), e = domain_corner(domain, wrap(k + 1, n));
    const domain_vector along = make_vector(e.xi - c.xi, e.eta - c.eta);
    const real slope = fma(gradient.xi, along.xi, gradient.eta * along.eta);
    // At corner b only side b may be followed forwards and side a backwards.
    if (held.b >= 0 && (which == 0 ? slope < K(0) : slope > K(0))) continue;
    const real flat = quadratic(first, along), whole = flat + quadratic(curvature_term, along);
    const real t = -slope / larger(whole > flat / K(16) ? whole : flat, TINY);
    if (-t * slope > gain) {
      gain = -t * slope;
      best = make_vector(t * along.xi, t * along.eta);
    }
  }
  return best;
}

// The step, cut where it leaves the domain; `side` is where (-1: it stays inside).
typedef struct {
  real length;
  int side;
} cut_step;

FN cut_step cut_at_sides(GLOBAL scalar* domain, int n, held_sides held, real xi, real eta,
                         domain_vector step) {
  cut_step r = {K(1), -1};
  for (int k = 0; k < n; ++k) {
    const real speed = outward(domain, k, step);
    if (!(speed > K(0)) || k == held.a || k == held.b) continue;
    const real length = side_distance(domain, n, k, xi, eta).f / speed;
    if (length < r.length) {
      r.length = length;
      r.side = k;
    }
  }
  return r;
}

FN sym2 start_curvature_term(surface_view view, foot f, track_options options) {
  GLOBAL scalar* numbers = numbers_of(view, f.patch) + PATCH_SECOND_FORM;
  const sym2 second = {numbers[0], numbers[1], numbers[2]};
  return curvature_term_of(f.d.at, f.d.r, second, options.solver);
}

// The curvature term of `from` in the domain of `to`, across an edge or a corner where the tangent
// planes are the same.
FN sym2 carry_curvature_term(surface_view view, foot from, foot to, track_options options) {
  const real3 u = from.d.at.g_xi, v = from.d.at.g_eta;
  const real a = dot3(u, u), b = dot3(u, v), c = dot3(v, v), det = a * c - b * b;
  if (options.solver != SOLVER_NEWTON || !(det > EPSILON * (a + c) * (a + c)))
    return start_curvature_term(view, to, options);
  const real over = K(1) / det;
  const real3 du = mul3(over, fma3(c, u, mul3(-b, v))), dv = mul3(over, fma3(a, v, mul3(-b, u)));
  const domain_vector x = make_vector(dot3(du, to.d.at.g_xi), dot3(dv, to.d.at.g_xi)),
                      y = make_vector(dot3(du, to.d.at.g_eta), dot3(dv, to.d.at.g_eta));
  const sym2 s = from.d.curvature_term;
  sym2 r = {quadratic(s, x),
            fma(x.xi, fma(s.a, y.xi, s.b * y.eta), x.eta * fma(s.b, y.xi, s.c * y.eta)),
            quadratic(s, y)};
  return r;
}

typedef struct {
  uint patch;
  real distance2;
} known_minimum;

// Follows the surface inside the patch as far as that goes. Returns how many steps that took.
FN int descend_foot(surface_view view, hip_point h, foot* f, track_options options) {
  const int n = valence_of(view, f->patch);
  const real so_far = f->d.evaluations;
  descend(domain_of(view, n), control_of(view, f->patch), view.form[f->patch], n,
          local_hip(view, h, f->patch), numbers_of(view, f->patch)[PATCH_UNSCALE], options, &f->d);
  const int steps = (int)(f->d.evaluations - so_far);
  options.spent->evaluations += steps + (f->d.refused ? 1 : 0);
  options.spent->steps += steps;
  if (steps > 0) f->flags &= ~(FOOT_BORDER | FOOT_CREASE);
  return steps;
}

// True if a descent goes on.
FN int is_descending(const foot* f, track_options options) {
  return !f->d.converged && f->d.evaluations < (real)options.max_iterations;
}

// How a step of a descent ends: the descent with it, in the same patch, or in another, over an edge
// or round a corner.
#define STEP_ENDS 0
#define STEP_STAYS 1
#define STEP_CROSSES 2
#define STEP_ROUNDS 3

FN int converge(foot* f) {
  f->d.converged = 1;
  return STEP_ENDS;
}

// A step that a foot may take, and the sides that hold the foot.
typedef struct {
  sym2 first;
  domain_vector gradient, way;
  real length2;            // squared, of the way before sides have turned it
  held_sides held, along;  // along: those that it follows
} foot_step;

FN int is_short(foot_step s, real length, track_options options) {
  return length * length * quadratic(s.first, s.way) <= options.tolerance * options.tolerance;
}

// The Newton step. A patch away the curvature is another: no farther than the tangent plane says.
FN foot_step choose_step(surface_view view, foot f) {
  const held_sides none = {-1, -1};
  const int n = valence_of(view, f.patch);
  foot_step s;
  s.first = first_form(f.d.at);
  s.gradient = gradient_of(f.d.at, f.d.r);
  s.way = newton_step(s.first, f.d.curvature_term, s.gradient);
  s.length2 = quadratic(s.first, s.way);
  s.held = sides_at(domain_of(view, n), n, f.d.xi, f.d.eta);
  s.along = none;
  if (s.length2 > K(1)) {
    const sym2 no_curvature_term = {K(0), K(0), K(0)};
    const domain_vector flat = newton_step(s.first, no_curvature_term, s.gradient);
    const real flat2 = quadratic(s.first, flat);
    if (flat2 < s.length2) {
      s.way = flat;
      s.length2 = flat2;
    }
  }
  return s;
}

// True if a step leads out over a side that holds the foot.
FN int leads_out(surface_view view, foot f, foot_step s) {
  GLOBAL scalar* domain = domain_of(view, valence_of(view, f.patch));
  return (s.held.a >= 0 && outward(domain, s.held.a, s.way) > K(0)) ||
         (s.held.b >= 0 && outward(domain, s.held.b, s.way) > K(0));
}

// The corner where `side` starts; of patch NONE, like the side.
FN domain_point corner_point(surface_view view, uint side) {
  domain_point r = {NONE, K(0), K(0)};
  if (side == NONE) return r;
  r.patch = view.side_patch[side];
  const domain_vector c = domain_corner(domain_of(view, valence_of(view, r.patch)),
                                        (int)(side - view.side_begin[r.patch]));
  r.xi = c.xi;
  r.eta = c.eta;
  return r;
}

// Returns the point of another patch where a foot that a step leads out goes on. Its patch is NONE
// where the foot goes on along its own sides: no other patch is there, or the step before, `last`,
// has brought the foot here. That step may have ended at a corner: the foot then goes round it.
FN domain_point leave_patch(surface_view view, foot* f, held_sides held, int last, effort* spent) {
  const int just_crossed = last == STEP_ROUNDS || (last == STEP_CROSSES && held.b < 0);
  const uint first = view.side_begin[f->patch];
  domain_point to = {NONE, f->d.xi, f->d.eta};
  int is_border = 1;
  if (held.b >= 0) {
    const uint side = first + (uint)held.b;
    const real3 way = mul3(K(-1), f->d.r);
    const fan_place fan = find_in_fan(view, side, way, spent);
    is_border = fan.is_border;
    const int leads_on = fan.side == NONE && !just_crossed;
    to = corner_point(view, leads_on ? edge_in_fan(view, side, way, spent) : fan.side);
  } else {
    const uint side = first + (uint)held.a, twin = view.side_twin[side];
    if (twin != NONE) to = cross_edge(view, side, twin, f->d.xi, f->d.eta);
  }
  if (to.patch != NONE && !just_crossed) return to;
  f->flags |= to.patch == NONE && is_border ? FOOT_BORDER : FOOT_CREASE;
  to.patch = NONE;
  return to;
}

// Goes on in a patch that a descent has come to from `from`, unless that is the patch of a known
// minimum, and no nearer.
FN int go_on_in_patch(surface_view view, foot from, foot* f, track_options options,
                      known_minimum known) {
  if (f->patch == known.patch && f->d.distance2 >= known.distance2) return STEP_ENDS;
  f->d.curvature_term = carry_curvature_term(view, from, *f, options);
  return STEP_CROSSES;
}

// True if a foot has come over a slit, between patches whose boundary curves are two, to where it
// is farther away; by rounding it may be once, and not to and fro.
FN int is_over_slit(surface_view view, foot from, foot to) {
  const real rounding = K(256) * EPSILON * numbers_of(view, to.patch)[PATCH_UNSCALE];
  return sqrt(to.d.distance2) > sqrt(from.d.distance2) + rounding ||
         (from.entered2 >= K(0) && to.d.distance2 >= from.entered2);
}

// Enters a patch over the sides that hold a foot; back from a slit it goes on along these.
FN int enter_patch(surface_view view, hip_point h, domain_point at, held_sides held, foot* f,
                   track_options options, known_minimum known) {
  const foot from = *f;
  const int is_sharp =
      held.b < 0 && !is_smooth_side(view, view.side_begin[f->patch] + (uint)held.a);
  *f = move_foot(view, h, from, at, options.spent);
  f->d.evaluations += K(1);
  if (is_sharp && is_over_slit(view, from, *f)) {
    const real evaluations = f->d.evaluations;
    *f = from;
    f->d.evaluations = evaluations;
    f->flags |= FOOT_CREASE;
    return STEP_STAYS;
  }
  if (is_sharp) f->entered2 = f->d.distance2;
  ++f->crossings;
  const int step = go_on_in_patch(view, from, f, options, known);
  if (step == STEP_CROSSES) f->d.last2 = -K(1);
  return step;
}

// The foot that a step has come to, and how far that is.
typedef struct {
  foot to;
  real length;  // of the step's way
  int crossed;
  int fell;  // the distance, or it is at its rounding
} trial;

// Quarters a step, cut where it leaves the patch, until the distance falls. Over a sharp edge,
// which may be a slit, it is the next step's to go.
FN trial search_along(surface_view view, hip_point h, foot f, foot_step s, track_options options) {
  const int n = valence_of(view, f.patch);
  const int at_rounding = is_at_rounding(s.gradient, s.way, f.d.r);
  const cut_step cut = cut_at_sides(domain_of(view, n), n, s.along, f.d.xi, f.d.eta, s.way);
  trial t = {f, cut.length, 0, 0};
  while (f.d.evaluations < (real)options.max_iterations) {
    domain_point p = {f.patch, fma(t.length, s.way.xi, f.d.xi), fma(t.length, s.way.eta, f.d.eta)};
    const int is_cut = t.length == cut.length && cut.side >= 0;
    t.crossed = 0;
    if (is_cut) {
      const uint side = view.side_begin[f.patch] + (uint)cut.side, twin = view.side_twin[side];
      t.crossed = twin != NONE && is_smooth_side(view, side);
      if (t.crossed) p = cross_edge(view, side, twin, p.xi, p.eta);
    }
    t.to = move_foot(view, h, f, p, options.spent);
    t.to.d.evaluations = f.d.evaluations += K(1);
    // From a hair's breadth beside a side onto it: no distance falls by that, and the step is not
    // over.
    const int too_short = is_short(s, t.length, options);
    t.fell = t.to.d.distance2 < f.d.distance2 || at_rounding || (too_short && is_cut);
    if (t.fell || too_short) break;
    t.length *= K(0.25f);
  }
  return t;
}

// Takes a step, with what it tells of the next.
FN int take_step(surface_view view, foot* f, foot_step s, trial t, track_options options,
                 known_minimum known) {
  const foot from = *f;
  f->d.evaluations = t.to.d.evaluations;
  // At the rounding of the distance, unless the iterations ran out.
  if (!t.fell) return is_descending(f, options) ? converge(f) : STEP_ENDS;
  const int follows = s.along.a >= 0;
  *f = t.to;
  f->crossings += t.crossed;
  if (!follows) f->flags &= ~(FOOT_BORDER | FOOT_CREASE);
  f->d.before2 = s.length2;
  f->d.last2 = t.crossed || follows ? -K(1) : t.length * t.length * s.length2;
  if (t.crossed) return go_on_in_patch(view, from, f, options, known);
  if (options.solver == SOLVER_NEWTON) {
    const domain_vector taken = make_vector(t.length * s.way.xi, t.length * s.way.eta);
    f->d.curvature_term =
        curvature_term_after(from.d.curvature_term, from.d.at, s.gradient, taken, f->d.at, f->d.r);
  }
  return STEP_STAYS;
}

// One step from where a descent within the patch stops: at a side, on a saddle, or before a step
// that is too long.
FN int step_foot(surface_view view, hip_point h, foot* f, int last, track_options options,
                 known_minimum known) {
  foot_step s = choose_step(view, *f);
  if (is_short(s, K(1), options)) return converge(f);
  if (leads_out(view, *f, s)) {
    const int walked = options.spent->fan_steps - options.spent->fan_begin;
    if (s.held.b >= 0 && walked > FAN_STEPS_A_DESCENT) return STEP_ENDS;
    const domain_point to = leave_patch(view, f, s.held, last, options.spent);
    if (to.patch != NONE) {
      const int step = enter_patch(view, h, to, s.held, f, options, known);
      if (step != STEP_STAYS) return step == STEP_CROSSES && s.held.b >= 0 ? STEP_ROUNDS : step;
    }
    const int n = valence_of(view, f->patch);
    s.along = s.held;
    s.way = edge_step(domain_of(view, n), n, s.held, s.first, f->d.curvature_term, s.gradient);
    if (is_short(s, K(1), options)) return converge(f);
  }
  if (is_at_rounding(s.gradient, s.way, f->d.r) && f->d.before2 > K(0) && s.length2 >= f->d.before2)
    return converge(f);
  return take_step(view, f, s, search_along(view, h, *f, s, options), options, known);
}

// Tracks the local nearest point from a start with its bend. An edge is crossed where the distance
// falls on its other side; having crossed, not again before it has fallen. Gives up on entering the
// patch of `known`, a minimum found before, at no less than its distance (patch NONE: never).
FN_LARGE void track_foot(surface_view view, hip_point h, foot* f, track_options options,
                         known_minimum known) {
  int step = STEP_STAYS;
  while (step != STEP_ENDS && is_descending(f, options)) {
    if (descend_foot(view, h, f, options) > 0) step = STEP_STAYS;
    if (is_descending(f, options)) step = step_foot(view, h, f, step, options, known);
  }
}

// The corner of the patch's domain that is nearest to a foot.
FN int corner_nearest_to(surface_view view, foot f) {
  const int n = valence_of(view, f.patch);
  GLOBAL scalar* domain = domain_of(view, n);
  int k = 0;
  real nearest = -K(1);
  for (int i = 0; i < n; ++i) {
    const domain_vector c = domain_corner(domain, i);
    const real dx = c.xi - f.d.xi, dy = c.eta - f.d.eta, d2 = fma(dx, dx, dy * dy);
    if (nearest < K(0) || d2 < nearest) {
      nearest = d2;
      k = i;
    }
  }
  return k;
}

// Moves a foot to a point of its patch's plane. Outside: over the side whose fan holds the point,
// where the ray from the centre meets it.
FN_LARGE foot move_as_printed(surface_view view, hip_point h, foot f, real xi, real eta,
                              effort* spent) {
  const int n = valence_of(view, f.patch);
  GLOBAL scalar* domain = domain_of(view, n);
  int out = -1;
  real farthest = domain[0];
  for (int i = 0; i < n; ++i) {
    const real reach = outward(domain, i, make_vector(xi, eta));
    if (reach > farthest) {
      farthest = reach;
      out = i;
    }
  }
  domain_point to = {f.patch, xi, eta};
  int crossed = 0;
  if (out >= 0) {
    to.xi = xi * (domain[0] / farthest);
    to.eta = eta * (domain[0] / farthest);
    const uint side = view.side_begin[f.patch] + (uint)out, twin = view.side_twin[side];
    if (twin != NONE) {
      to = cross_edge(view, side, twin, to.xi, to.eta);
      crossed = 1;
    } else {
      f.flags |= FOOT_BORDER;
    }
  }
  f = move_foot(view, h, f, to, spent);
  f.d.evaluations += K(1);
  f.crossings += crossed;
  return f;
}

// Section 4.2 as printed, to be compared with: secants of length lambda = 0.1 towards the
// neighbours of the nearest corner, no safeguard; over an edge to where the ray from the centre
// meets it (4.3). Ends by the residual angle. An iteration takes three evaluations: with the budget
// spent it ends after as many of these as other solvers take.
FN_LARGE foot track_as_printed(surface_view view, hip_point h, foot f, track_options options) {
  const real most = (real)options.max_iterations;
  while (f.d.evaluations < most && (K(3) * f.d.evaluations < most || !is_spent(options.spent))) {
    const int n = valence_of(view, f.patch), k = corner_nearest_to(view, f);
    GLOBAL scalar* domain = domain_of(view, n);
    const domain_vector c = domain_corner(domain, k), next = domain_corner(domain, wrap(k + 1, n)),
                        prev = domain_corner(domain, wrap(k - 1, n));
    const real lambda = K(1) / K(10);
    const domain_vector xa = make_vector(lambda * (next.xi - c.xi), lambda * (next.eta - c.eta));
    const domain_vector xb = make_vector(lambda * (prev.xi - c.xi), lambda * (prev.eta - c.eta));
    const domain_point at_a = {f.patch, f.d.xi + xa.xi, f.d.eta + xa.eta},
                       at_b = {f.patch, f.d.xi + xb.xi, f.d.eta + xb.eta};
    const real3 a = sub3(evaluate_aside(view, at_a, options.spent).g, f.d.at.g);
    const real3 b = sub3(evaluate_aside(view, at_b, options.spent).g, f.d.at.g);
    const real3 normal = cross3(a, b);
    const real3 off = cross3(f.d.r, normal);  // |r| |n| sin of the residual angle
    const real limit = options.tolerance * options.tolerance;
    if (dot3(off, off) <= limit * dot3(f.d.r, f.d.r) * dot3(normal, normal)) {
      f.d.converged = 1;
      break;
    }
    const sym2 secants = {dot3(a, a), dot3(a, b), dot3(b, b)};
    const sym2 none = {K(0), K(0), K(0)};
    const domain_vector step =
        newton_step(secants, none, make_vector(dot3(a, f.d.r), dot3(b, f.d.r)));
    f = move_as_printed(view, h, f, fma(step.xi, xa.xi, fma(step.eta, xb.xi, f.d.xi)),
                        fma(step.xi, xa.eta, fma(step.eta, xb.eta, f.d.eta)), options.spent);
  }
  return f;
}
