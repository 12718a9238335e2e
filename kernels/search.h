// The two queries, for the Gregory surface and for its base polygons: the nearest point of all, and
// the local one that a contact follows.

FN base_point base_point_on(surface_view view, hip_point h, uint patch, int whole) {
  base_point b;
  b.patch = patch;
  b.whole = whole;
  b.at = nearest_on_polygon(view, patch, local_hip(view, h, patch), whole);
  const real unscale = numbers_of(view, patch)[PATCH_UNSCALE];
  b.distance2 = b.at.distance2 * unscale * unscale;
  return b;
}

FN real patch_box_distance2(surface_view view, hip_point h, uint patch) {
  return oriented_box_distance2(numbers_of(view, patch), h);
}

// Patches near a HIP, by the distances to both of their boxes and then by number: all that are
// nearer than `complete2`.
#define NEAR_PATCHES 24
typedef struct {
  int count;
  uint patch[NEAR_PATCHES];
  real box2[NEAR_PATCHES];
  real complete2;
} near_patches;

FN int comes_before(real box2, uint patch, real other2, uint other) {
  return box2 < other2 || (box2 == other2 && patch < other);
}

// Adds a patch in its place. Where there is no room the last one is left out.
FN void add_near(near_patches* near, uint patch, real box2) {
  int at = near->count;
  if (at == NEAR_PATCHES) {
    --at;
    if (!comes_before(box2, patch, near->box2[at], near->patch[at])) {
      near->complete2 = smaller(near->complete2, box2);
      return;
    }
    near->complete2 = smaller(near->complete2, near->box2[at]);
  } else {
    ++near->count;
  }
  for (; at > 0 && comes_before(box2, patch, near->box2[at - 1], near->patch[at - 1]); --at) {
    near->box2[at] = near->box2[at - 1];
    near->patch[at] = near->patch[at - 1];
  }
  near->box2[at] = box2;
  near->patch[at] = patch;
}

// How far a HIP is from the middle of the mesh, which lies in [-1, 1]^3, at most; the squares of
// distances of HIPs within FAR_AWAY do not overflow.
FN real reach_of_hip(hip_point h) { return fabs(h.high.x) + fabs(h.high.y) + fabs(h.high.z); }
#define FAR_AWAY K(0x1p40f)

FN real square(real x) { return x * x; }

// base_search holds the nearest point of the base polygons so far, and limits of distance, squared:
// within the first may be a nearer polygon, within the other a nearer patch. They differ, because
// points of a patch may be off its base polygon by its sag.
typedef struct {
  base_point at;
  real nearer2, reach2;
} base_search;

// Returns the rounding error of a box's distance: the box of a polygon that is as near may look
// this much farther away.
FN real box_slack(hip_point h) { return K(16) * EPSILON * (K(1) + reach_of_hip(h)); }

FN void set_limits(surface_view view, base_search* s, real slack) {
  GLOBAL scalar* numbers = numbers_of(view, s->at.patch);
  const real distance = sqrt(s->at.distance2) + slack;
  s->nearer2 = square(distance);
  s->reach2 = smaller(s->reach2, square(fma(numbers[PATCH_SAG], numbers[PATCH_UNSCALE], distance)));
}

FN base_search start_base_search(surface_view view, hip_point h, uint guess, int whole) {
  base_search s;
  s.at = base_point_on(view, h, guess, whole);
  s.reach2 = K(INFINITY);
  set_limits(view, &s, box_slack(h));
  return s;
}

// Tries the base polygon of another patch.
FN void try_base(surface_view view, hip_point h, uint patch, base_search* s) {
  const base_point b = base_point_on(view, h, patch, s->at.whole);
  if (!comes_before(b.distance2, patch, s->at.distance2, s->at.patch)) return;
  s->at = b;
  set_limits(view, s, box_slack(h));
}

// Finds the nearest point of all base polygons; of equally near ones that of the lowest patch. A
// HIP that is not a number, or so far away that its distance may overflow, gets the point on patch
// 0. With `keeps` it looks at the patches' own base polygons, and also keeps in `near` the patches
// that may hold a point as near as the patch there is expected to; else it looks at the polygons
// themselves. `guess`: a patch that may be near; it shortens the walk and does not change what is
// found. `part`: only the patches of that part, which `guess` is one of; NONE: all.
FN_LARGE base_point nearest_base_of(surface_view view, hip_point h, uint guess, uint part,
                                    int keeps, near_patches* near) {
  near->count = 0;
  near->complete2 = K(0);
  if (!(reach_of_hip(h) <= FAR_AWAY)) return base_point_on(view, h, 0u, !keeps);
  walk w = start_walk(view);
  base_search s = start_base_search(view, h, guess, !keeps);
  if (keeps) near->complete2 = K(INFINITY);
  for (;;) {
    const real limit2 = keeps ? s.reach2 : s.nearer2;
    const uint p = next_patch(view, &w, h.high, limit2);
    if (p == NONE) break;
    if (part != NONE && part_of(view, p) != part) continue;
    const real box2 = larger(patch_box_distance2(view, h, p), last_box_distance2(&w));
    if (!(box2 < limit2)) continue;
    if (p != guess && box2 < s.nearer2) try_base(view, h, p, &s);
    if (keeps) add_near(near, p, box2);
  }
  if (keeps) near->complete2 = smaller(near->complete2, s.reach2);
  return s.at;
}
FN base_point nearest_base(surface_view view, hip_point h, uint guess, int keeps,
                           near_patches* near) {
  return nearest_base_of(view, h, guess, NONE, keeps, near);
}

// The nearest point of the polygon of a face, of which a patch is given.
FN_LARGE base_point point_on_face(surface_view view, hip_point h, uint patch) {
  const polygon_sides s = polygon_of(view, patch, 1);
  base_point best = base_point_on(view, h, patch, 1);
  for (int k = 0; s.stride > 1 && k < s.n; ++k) {
    const base_point b = base_point_on(view, h, view.side_patch[s.first + 3 * (uint)k], 1);
    if (b.distance2 < best.distance2) best = b;
  }
  return best;
}

// A face that is nearer to the HIP than `from`, across the side or round the corner that holds it
// (the best of the fan); `from` itself where there is none.
FN base_point nearer_neighbour(surface_view view, hip_point h, base_point from) {
  const polygon_sides s = polygon_of(view, from.patch, 1);
  const polygon_place place = place_on_polygon(s.n, from.at);
  base_point best = from;
  if (place.side >= 0) {
    const uint twin = view.side_twin[s.first + (uint)place.side * s.stride];
    if (twin == NONE) return from;
    const base_point b = point_on_face(view, h, view.side_patch[twin]);
    if (b.distance2 < best.distance2) best = b;
  } else if (place.corner >= 0) {
    fan_walk fan = start_fan(s.first + (uint)place.corner * s.stride);
    for (uint at = next_in_fan(view, &fan); at != NONE; at = next_in_fan(view, &fan)) {
      const base_point b = point_on_face(view, h, view.side_patch[at]);
      if (b.distance2 < best.distance2) best = b;
    }
  }
  return best;
}

// The god-object on the base polygons: slides from polygon to polygon while that brings it nearer
// to the HIP, so that it rests at a local minimum (Zilles and Salisbury 1995).
FN_LARGE base_point track_base(surface_view view, hip_point h, uint patch, int max_crossings) {
  base_point at = point_on_face(view, h, patch);
  for (int i = 0; i < max_crossings; ++i) {
    const base_point next = nearer_neighbour(view, h, at);
    if (next.patch == at.patch) break;
    at = next;
  }
  return at;
}

// Evaluated where a search starts; end_foot goes on from there, or from where lanes have brought it
// (descent.h).
FN foot begin_foot(surface_view view, hip_point h, domain_point at, track_options options) {
  foot f = start_foot(view, h, at, options.spent);
  f.d.curvature_term = start_curvature_term(view, f, options);
  return f;
}

// True if a foot may have become a top, as where the HIP goes straight through a ball: no step was
// needed, or one of rounding, or an edge holds it, as in a plane of symmetry. Deeper than the
// radius of curvature ways lead down from there, at a corner from any depth.
FN int may_be_top(surface_view view, const foot* f) {
  if (!f->d.converged || (f->flags & FOOT_BORDER)) return 0;
  const real curvature = numbers_of(view, f->patch)[PATCH_CURVATURE];
  const int is_deep = dot3(f->d.r, f->d.r) * curvature * curvature > K(1),
            stays = f->d.evaluations <= K(1) && f->d.before2 < K(0x1p-30f);
  if (!is_deep && !stays && !(f->flags & FOOT_CREASE)) return 0;
  const int n = valence_of(view, f->patch);
  const held_sides held = sides_at(domain_of(view, n), n, f->d.xi, f->d.eta);
  return held.b >= 0 || (is_deep && (stays || held.a >= 0));
}

// Tracks a foot on, for another HIP.
FN void track_for(surface_view view, hip_point h, foot* f, track_options options,
                  known_minimum known) {
  const descent last = f->d;
  begin_descent(&f->d);
  f->d.evaluations = last.evaluations;
  move_descent(&f->d, make_vector(last.xi, last.eta), last.at, local_hip(view, h, f->patch),
               numbers_of(view, f->patch)[PATCH_UNSCALE]);
  f->d.curvature_term = start_curvature_term(view, *f, options);
  track_foot(view, h, f, options, known);
}

// Moves a foot to where it comes back to after the HIP has gone a little aside, if that is nearer.
FN_LARGE void leave_top(surface_view view, hip_point h, foot* f, track_options options,
                        known_minimum known) {
  const real3 back = unit3(f->d.r);
  real3 way = mul3(K(0x1p-14f) * sqrt(f->d.distance2), unit3(f->d.at.g_xi));
  real evaluations = f->d.evaluations;
  for (int i = 0; i < 4; ++i) {
    hip_point aside = h;
    aside.low = add3(h.low, way);
    way = cross3(back, way);
    foot next = *f;
    next.d.evaluations = evaluations;
    track_for(view, aside, &next, options, known);
    track_for(view, h, &next, options, known);
    evaluations = next.d.evaluations;
    if (!(next.d.distance2 < (K(1) - K(0x1p-18f)) * f->d.distance2)) continue;
    *f = next;
    return;
  }
}

FN void end_foot(surface_view view, hip_point h, foot* f, track_options options,
                 known_minimum known) {
  if (options.solver == SOLVER_PAPER) {
    *f = track_as_printed(view, h, *f, options);
    return;
  }
  if (is_descending(f, options)) track_foot(view, h, f, options, known);
  if (may_be_top(view, f)) leave_top(view, h, f, options, known);
}

// Where the nearest point of a base polygon lies in the domain (4.1).
FN domain_point start_at(uint patch, polygon_blend blend) {
  domain_point r = {patch, blend.xi, blend.eta};
  return r;
}
FN domain_point start_on_base(surface_view view, base_point base) {
  return start_at(base.patch, blend_on_polygon(view, base));
}

// True if `a` should replace `b`: it is nearer by more than rounding, or as near and only `a` has
// converged. Rounding alone must not decide which patch a search ends on.
FN int is_nearer(foot a, foot b) {
  const real rounding = K(8) * EPSILON * b.d.distance2;
  const int converges = a.d.converged && !b.d.converged;
  return a.d.distance2 < b.d.distance2 + (converges ? rounding : -rounding);
}

// The better of what a search has found and another foot of it.
FN foot better_foot(foot best, foot f) {
  const real clear2 = best.clear2;
  if (best.patch == NONE || is_nearer(f, best)) best = f;
  best.clear2 = clear2;
  return best;
}

// Tiles of a patch that may hold a nearest point nearer than what is known.
#define OPEN_TILES 32
typedef struct {
  int count, left;  // left: those that are neither started from nor settled
  int tile[OPEN_TILES];
  int is_closed[OPEN_TILES];
  real distance2[OPEN_TILES];  // no point of it is nearer
  real height[OPEN_TILES];
  domain_vector middle[OPEN_TILES];
} open_tiles;

// Rounding of a distance does not close a tile.
FN real open_below(real distance2) { return distance2 + K(32) * EPSILON * distance2; }

// Gathers open tiles from `next` on; returns where to go on.
FN int gather_tiles(surface_view view, patch_tiles tiles, int next, real distance2,
                    open_tiles* open) {
  GLOBAL scalar* domain = domain_of(view, tiles.n);
  const real below = open_below(distance2), distance = sqrt(open_below(below) / tiles.unscale2);
  open->count = open->left = 0;
  for (; next < tiles.at.count; next += TILES_AT_ONCE) {
    ulong near = NEAR_TILES(tiles.at, next, distance);
    for (; near != 0; near &= near - 1) {
      const int tile = next + lowest_bit(near);
      const tile_reach reach = reach_of(tiles.at, tile);
      const real least2 = reach.distance2 * tiles.unscale2;
      if (!(least2 < below) || !reach.has_foot) continue;
      if (open->count == OPEN_TILES) return tile;
      const int at = open->count++;
      ++open->left;
      open->tile[at] = tile;
      open->is_closed[at] = 0;
      open->distance2[at] = least2;
      open->height[at] = reach.height;
      open->middle[at] = middle_of(tiles, domain, tile);
    }
  }
  return tiles.at.count;
}

// Settles the open tiles in sight of where a descent began or ended, no farther than `most` in the
// domain: those to which the squared distance is convex all the way.
FN_LARGE void rule_out_tiles(surface_view view, patch_tiles tiles, domain_vector at, real most,
                             real distance, open_tiles* open) {
  GLOBAL scalar* domain = domain_of(view, tiles.n);
  for (int i = 0; i < open->count; ++i) {
    const real xi = open->middle[i].xi - at.xi, eta = open->middle[i].eta - at.eta;
    if (open->is_closed[i] || fma(xi, xi, eta * eta) > most * most ||
        !is_convex(tiles, open->tile[i], open->height[i], distance) ||
        !is_convex_between(tiles, domain, at, open->middle[i], distance))
      continue;
    open->is_closed[i] = 1;
    --open->left;
  }
}

// The open tile that no point is nearer than, of those not settled; -1 where all are farther than
// what is known.
FN int nearest_open(const open_tiles* open, real distance2) {
  int found = -1;
  real least = open_below(distance2);
  for (int i = 0; i < open->count; ++i) {
    if (open->is_closed[i] || !(open->distance2[i] < least)) continue;
    least = open->distance2[i];
    found = i;
  }
  return found;
}

// True if nowhere in a patch the distance of a minimum is beyond half the radius of curvature.
FN int is_within_half_radius(surface_view view, foot f, uint patch) {
  GLOBAL scalar* numbers = numbers_of(view, patch);
  const real curvature = numbers[PATCH_CURVATURE] * numbers[PATCH_SCALE];
  return f.d.distance2 * curvature * curvature < K(0.25f);
}

// True if a minimum is the only one of its patch.
FN int is_sole_minimum(surface_view view, foot f) {
  return f.d.converged && is_within_half_radius(view, f, f.patch);
}

// True if a patch joins another along one of its sides, with one normal there.
FN int joins(surface_view view, uint patch, uint other) {
  const uint first = view.side_begin[patch], end = view.side_begin[patch + 1];
  for (uint side = first; side < end; ++side) {
    const uint twin = view.side_twin[side];
    if (twin != NONE && view.side_patch[twin] == other && is_smooth_side(view, side)) return 1;
  }
  return 0;
}

// True if no point of another patch is nearer than a minimum that is its own patch's only one, and
// that no border or crease holds: the patches join, in both the distance is within half the radius
// of curvature, and the other's polygon is turned by less than 60 degrees from the minimum's
// normal. So the surface does not come back to the HIP there.
FN int is_sole_beside(surface_view view, foot f, uint patch) {
  if ((f.flags & (FOOT_BORDER | FOOT_CREASE)) || !is_sole_minimum(view, f) ||
      !is_within_half_radius(view, f, patch))
    return 0;
  const real3 normal = patch_normal(f.d.at), other = load3(numbers_of(view, patch), PATCH_NORMAL);
  if (!(dot3(normal, other) > K(0.5f) * norm3(normal))) return 0;
  const int is_smaller = valence_of(view, patch) < valence_of(view, f.patch);
  return joins(view, is_smaller ? patch : f.patch, is_smaller ? f.patch : patch);
}

// True if the squared distance is convex all the way to the minimum that is known, in its patch.
FN int leads_to(surface_view view, hip_point h, foot f, foot best) {
  if (f.patch != best.patch || !best.d.converged) return 0;
  const patch_tiles tiles = tiles_of(view, h, f.patch);
  return is_convex_between(tiles, domain_of(view, tiles.n), make_vector(f.d.xi, f.d.eta),
                           make_vector(best.d.xi, best.d.eta),
                           sqrt(best.d.distance2) * numbers_of(view, f.patch)[PATCH_SCALE]);
}

// Leaps on along the way from one foot of a descent to the next, for as long as that is nearer.
// Where the distance is nearly level, along a valley or a ridge, steps are short.
FN_LARGE foot leap_ahead(surface_view view, hip_point h, foot from, foot f, track_options options) {
  if (f.patch != from.patch) return f;
  const int n = valence_of(view, f.patch);
  const domain_vector way = make_vector(f.d.xi - from.d.xi, f.d.eta - from.d.eta);
  for (real length = K(4); f.d.evaluations < options.max_iterations; length *= K(4)) {
    const domain_vector at =
        make_vector(fma(length, way.xi, f.d.xi), fma(length, way.eta, f.d.eta));
    if (!is_inside(domain_of(view, n), n, at)) break;
    ++f.d.evaluations;
    const domain_point there = {f.patch, at.xi, at.eta};
    const foot to = move_foot(view, h, f, there, options.spent);
    if (!(to.d.distance2 < f.d.distance2)) break;
    f = to;
    f.flags &= ~(FOOT_BORDER | FOOT_CREASE);
    f.d.last2 = f.d.before2 = -K(1);
  }
  return f;
}

// The squared distance (mesh frame) that a foot is above the minimum of its model, a step away.
FN real fall_of(surface_view view, foot f, domain_vector step) {
  const domain_vector gradient = gradient_of(f.d.at, f.d.r);
  const real unscale = numbers_of(view, f.patch)[PATCH_UNSCALE];
  return -fma(gradient.xi, step.xi, gradient.eta * step.eta) * unscale * unscale;
}

// True if a step takes a foot to the minimum that is known, but for a quarter of the way at most.
FN int steps_to(foot f, domain_vector step, sym2 first, foot best) {
  if (f.patch != best.patch || !best.d.converged) return 0;
  const domain_vector way = make_vector(best.d.xi - f.d.xi, best.d.eta - f.d.eta),
                      rest = make_vector(way.xi - step.xi, way.eta - step.eta);
  return quadratic(first, rest) <= K(0x1p-4f) * quadratic(first, way);
}

// A descent falls by no more than so many times what its model says. It is asked after so many
// steps, or, where it is nearer than what is known, whether it creeps.
#define MOST_FALL K(3)
#define STEPS_AT_ONCE 2
#define STEPS_NEARER 16

// Descends from the middle of a tile for as long as that may lead to a nearer minimum. From where
// it is nearer than what is known it goes on all the way.
FN_LARGE foot descend_from_tile(surface_view view, hip_point h, foot f, track_options options,
                                foot best) {
  // A minimum that is its patch's only one needs no search there.
  const int is_sole = is_sole_minimum(view, best);
  const known_minimum known = {is_sole ? best.patch : NONE, best.d.distance2};
  track_options some = options;
  int steps = STEPS_AT_ONCE;
  while (f.d.evaluations < options.max_iterations) {
    const foot from = f;
    some.max_iterations =
        (int)f.d.evaluations + (f.d.distance2 < best.d.distance2 ? STEPS_NEARER : steps);
    if (some.max_iterations > options.max_iterations) some = options;
    end_foot(view, h, &f, some, known);
    if (f.d.converged || f.d.evaluations == from.d.evaluations) break;
    const sym2 first = first_form(f.d.at);
    const newton_model model = model_of(first, f.d.curvature_term);
    const int fell = f.d.distance2 < from.d.distance2;
    if (fell && !model.is_sound) f = leap_ahead(view, h, from, f, options);
    if (f.d.distance2 < best.d.distance2) continue;
    if (is_sole && f.patch == best.patch) break;
    if (!fell) {  // where so many do not suffice to shorten a step
      steps *= 2;
      continue;
    }
    if (model.is_sound && options.solver == SOLVER_NEWTON) {
      const domain_vector step = solve(model.m, model.det, gradient_of(f.d.at, f.d.r));
      if (f.d.distance2 - MOST_FALL * fall_of(view, f, step) > best.d.distance2) break;
      if (steps_to(f, step, first, best)) break;
    }
    if (leads_to(view, h, f, best)) break;
  }
  return f;
}

// One start from an open tile, and what it settles.
FN foot search_tile(surface_view view, hip_point h, patch_tiles tiles, int from, open_tiles* open,
                    track_options options, foot best) {
  const uint patch = tiles.patch;
  const real scale = numbers_of(view, patch)[PATCH_SCALE];
  const domain_vector at = open->middle[from];
  const int tile = open->tile[from];
  const domain_point middle = {patch, at.xi, at.eta};
  foot f = start_foot(view, h, middle, options.spent);
  f.d.curvature_term = curvature_term_of(f.d.at, f.d.r, second_of(tiles, tile), options.solver);
  f = descend_from_tile(view, h, f, options, best);
  best = better_foot(best, f);
  open->is_closed[from] = 1;
  --open->left;
  const real distance = sqrt(best.d.distance2) * scale;
  if (open->left == 0) return best;
  if (f.patch != patch) {  // out of a convex tile: out of its neighbours as well
    if (is_convex(tiles, tile, open->height[from], distance))
      rule_out_tiles(view, tiles, at, K(0.7f) / (real)tiles.levels, distance, open);
  } else if (f.d.converged) {
    rule_out_tiles(view, tiles, make_vector(f.d.xi, f.d.eta), K(2), distance, open);
  }
  return best;
}

// The better of a known minimum and those of a patch. A search starts from the middle of each tile
// that may hold a nearer point, but where a convex neighbourhood has but one minimum.
FN_LARGE foot search_tiles(surface_view view, hip_point h, uint patch, track_options options,
                           foot best) {
  const real scale = numbers_of(view, patch)[PATCH_SCALE];
  const patch_tiles tiles = tiles_of(view, h, patch);
  open_tiles open;
  for (int next = 0; next < tiles.at.count;) {
    next = gather_tiles(view, tiles, next, best.d.distance2, &open);
    if (best.patch == patch && open.left > 0 && best.d.converged)
      rule_out_tiles(view, tiles, make_vector(best.d.xi, best.d.eta), K(2),
                     sqrt(best.d.distance2) * scale, &open);
    while (open.left > 0) {
      const int from = nearest_open(&open, best.d.distance2);
      if (from < 0) break;
      if (is_spent(options.spent)) {
        best.clear2 = smaller(open.distance2[from], best.clear2);
        break;
      }
      best = search_tile(view, h, tiles, from, &open, options, best);
    }
  }
  return best;
}

// The same, without a search where the minimum that is known rules it out.
FN foot search_patch(surface_view view, hip_point h, uint patch, track_options options, foot best) {
  const int is_sole =
      best.patch == patch ? is_sole_minimum(view, best) : is_sole_beside(view, best, patch);
  return is_sole ? best : search_tiles(view, h, patch, options, best);
}

// Ends a search: clear2 and FOOT_UNFINISHED say what it left out.
FN foot finish_search(foot best) {
  const real rounding = K(64) * EPSILON * best.clear2;
  if (best.clear2 - rounding < best.d.distance2) {
    best.clear2 = best.clear2 - rounding;
    best.flags |= FOOT_UNFINISHED;
  } else {
    best.clear2 = best.d.distance2;
  }
  return best;
}

// Patches whose tiles a search with a budget looks at, for each of its evaluations.
#define PATCHES_AN_EVALUATION 4
FN int is_enough(int patches, const effort* spent) {
  return spent->budget > 0 && patches / PATCHES_AN_EVALUATION >= spent->budget;
}

// The patches whose boxes are nearer than `limit2`, if there is room for them.
FN_LARGE void find_near(surface_view view, hip_point h, real limit2, near_patches* near) {
  walk w = start_walk(view);
  near->count = 0;
  near->complete2 = limit2;
  for (uint p = next_patch(view, &w, h.high, limit2); p != NONE;
       p = next_patch(view, &w, h.high, limit2)) {
    const real box2 = larger(patch_box_distance2(view, h, p), last_box_distance2(&w));
    if (box2 < limit2) add_near(near, p, box2);
  }
}

// Goes on with all patches that come after those of a list, in the order of a walk.
FN_LARGE foot search_beyond(surface_view view, hip_point h, uint first, const near_patches* near,
                            track_options options, foot best) {
  const uint last = near->patch[near->count - 1];
  const real last2 = near->box2[near->count - 1];
  walk w = start_walk(view);
  int searched = near->count;
  for (uint p = next_patch(view, &w, h.high, best.d.distance2); p != NONE;
       p = next_patch(view, &w, h.high, best.d.distance2)) {
    const real box2 = larger(patch_box_distance2(view, h, p), last_box_distance2(&w));
    if (p == first || !(box2 < best.d.distance2) || !comes_before(last2, last, box2, p)) continue;
    if (is_enough(searched++, options.spent)) {
      best.clear2 = smaller(box2, best.clear2);
    } else {
      best = search_patch(view, h, p, options, best);
    }
  }
  return best;
}

// Nearest point of the whole surface: from `first`, on the nearest base polygon of all, then from
// every patch whose box is nearer, the nearest boxes first. The same whatever list of near patches
// is there.
FN_LARGE foot nearest_foot(surface_view view, hip_point h, const foot* first,
                           const near_patches* near, track_options options) {
  const known_minimum none = {NONE, K(0)};
  foot best = *first;
  end_foot(view, h, &best, options, none);
  best.clear2 = K(INFINITY);
  best = search_patch(view, h, first->patch, options, best);
  const real rounding = K(64) * EPSILON * best.d.distance2;
  near_patches all;
  if (!(best.d.distance2 + rounding <= near->complete2)) {
    find_near(view, h, best.d.distance2 + rounding, &all);
    near = &all;
  }
  for (int i = 0; i < near->count && near->box2[i] < best.d.distance2; ++i) {
    if (near->patch[i] == first->patch) continue;
    if (is_enough(i, options.spent)) {
      best.clear2 = smaller(near->box2[i], best.clear2);
    } else {
      best = search_patch(view, h, near->patch[i], options, best);
    }
  }
  if (near->complete2 < best.d.distance2)
    best = search_beyond(view, h, first->patch, near, options, best);
  return finish_search(best);
}
