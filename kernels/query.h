// The two queries, for the Gregory surface and for its base polygons: the nearest point of all, and
// the local one that a contact follows.

typedef struct {
  uint patch;
  polygon_point at;
  real distance2;  // squared, mesh frame
} base_point;

FN base_point base_point_on(surface_view view, hip_point h, uint patch) {
  base_point b;
  b.patch = patch;
  b.at = nearest_on_polygon(view, patch, local_hip(view, h, patch));
  const real unscale = numbers_of(view, patch)[PATCH_UNSCALE];
  b.distance2 = b.at.distance2 * unscale * unscale;
  return b;
}

// Squared distance (mesh frame) from the HIP to the oriented box of a patch: no point of the patch
// or of its base polygon is nearer.
FN real patch_box_distance2(surface_view view, hip_point h, uint patch) {
  GLOBAL scalar* numbers = numbers_of(view, patch);
  const real3 normal = load3(numbers, PATCH_NORMAL), tangent = load3(numbers, PATCH_TANGENT);
  const real3 x = local_hip(view, h, patch);
  const real3 along = make3(dot3(x, tangent), dot3(x, cross3(normal, tangent)), dot3(x, normal));
  const real3 low = sub3(load3(numbers, PATCH_LOW), along),
              high = sub3(along, load3(numbers, PATCH_HIGH));
  const real zero = K(0);
  const real3 out = make3(larger(larger(low.x, high.x), zero), larger(larger(low.y, high.y), zero),
                          larger(larger(low.z, high.z), zero));
  const real unscale = numbers[PATCH_UNSCALE];
  return dot3(out, out) * unscale * unscale;
}

// Patches that a walk for the nearest base polygon came by, in its order: all whose oriented boxes
// are nearer than `complete2`.
#define NEAR_PATCHES 24
typedef struct {
  int count;
  uint patch[NEAR_PATCHES];
  real box2[NEAR_PATCHES];
  real complete2;
} near_patches;

// Nearest point of all base polygons; on the first where the HIP is not a number or its distance
// overflows. Where patches are asked for, also those that may hold a point as near as the patch
// there is expected to.
FN_LARGE base_point nearest_base(surface_view view, hip_point h, int keeps, near_patches* near) {
  walk w = start_walk(view);
  base_point best = base_point_on(view, h, 0u);
  real limit2 = K(0x1p126f);
  near->count = 0;
  near->complete2 = K(0);
  if (!(best.distance2 <= limit2)) return best;
  for (uint p = next_patch(view, &w, h.high, limit2); p != NONE;
       p = next_patch(view, &w, h.high, limit2)) {
    const real box2 = patch_box_distance2(view, h, p);
    if (!(box2 < limit2)) continue;
    if (box2 < best.distance2) {
      const base_point b = base_point_on(view, h, p);
      if (b.distance2 < best.distance2) best = b;
    }
    keeps = keeps && near->count < NEAR_PATCHES;
    real reach2 = best.distance2;
    if (keeps) {
      near->patch[near->count] = p;
      near->box2[near->count++] = box2;
      GLOBAL scalar* numbers = numbers_of(view, best.patch);
      const real reach = sqrt(best.at.distance2) + numbers[PATCH_SAG];
      reach2 = reach * reach * numbers[PATCH_UNSCALE] * numbers[PATCH_UNSCALE];
    }
    if (reach2 < limit2) limit2 = reach2;
  }
  if (keeps) near->complete2 = limit2;
  return best;
}

// A base polygon that is nearer to the HIP than `from`, across the side or round the corner that
// holds it (the best of the fan); `from` itself where there is none.
FN base_point nearer_neighbour(surface_view view, hip_point h, base_point from) {
  const int n = valence_of(view, from.patch);
  const polygon_place place = place_on_polygon(n, from.at);
  const uint first = view.side_begin[from.patch];
  base_point best = from;
  if (place.side >= 0) {
    const uint twin = view.side_twin[first + (uint)place.side];
    if (twin == NONE) return from;
    const base_point b = base_point_on(view, h, view.side_patch[twin]);
    if (b.distance2 < best.distance2) best = b;
  } else if (place.corner >= 0) {
    const uint start = first + (uint)place.corner;
    uint at = view.side_twin[prev_in_patch(view, start)];
    while (at != NONE && at != start) {
      const base_point b = base_point_on(view, h, view.side_patch[at]);
      if (b.distance2 < best.distance2) best = b;
      at = view.side_twin[prev_in_patch(view, at)];
    }
    if (at == NONE) {
      at = view.side_twin[start];
      while (at != NONE) {
        at = next_in_patch(view, at);
        const base_point b = base_point_on(view, h, view.side_patch[at]);
        if (b.distance2 < best.distance2) best = b;
        at = view.side_twin[at];
      }
    }
  }
  return best;
}

// The god-object on the base polygons: slides from polygon to polygon while that brings it nearer
// to the HIP, so that it rests at a local minimum (Zilles and Salisbury 1995).
FN_LARGE base_point track_base(surface_view view, hip_point h, uint patch, int max_crossings) {
  base_point at = base_point_on(view, h, patch);
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
  foot f = start_foot(view, h, at.patch, at.xi, at.eta);
  f.bend = start_bend(view, f, options);
  return f;
}
FN foot end_foot(surface_view view, hip_point h, foot f, track_options options,
                 known_minimum known) {
  return options.solver == SOLVER_PAPER ? track_as_printed(view, h, f, options)
                                        : track_foot(view, h, f, options, known);
}

// Where the nearest point of a base polygon lies in the domain (4.1).
FN domain_point start_on_base(surface_view view, base_point base) {
  const polygon_blend blend = blend_on_polygon(view, base.patch, base.at);
  domain_point r = {base.patch, blend.xi, blend.eta};
  return r;
}

// Whether to go on with `a`: not for a rounding, by which other patches would decide, but where it
// alone has converged.
FN int is_nearer(foot a, foot b) {
  const real rounding = K(8) * EPSILON * b.distance2;
  const int converges = (a.flags & FOOT_CONVERGED) && !(b.flags & FOOT_CONVERGED);
  return a.distance2 < b.distance2 + (converges ? rounding : -rounding);
}

// The better of a known minimum and those reached from a patch: from `first`, on its base polygon;
// where the HIP is so far that the patch may have several, also from its centre and from near its
// corners.
FN_LARGE foot search_patch(surface_view view, hip_point h, foot first, track_options options,
                           foot best) {
  const uint p = first.patch;
  const int n = valence_of(view, p);
  GLOBAL scalar* numbers = numbers_of(view, p);
  GLOBAL scalar* domain = domain_of(view, n);
  const real rho = numbers[PATCH_RHO] * numbers[PATCH_UNSCALE] / K(2);
  const int corners = n < 8 ? n : 8;  // that are started from
  int starts = 1, iterations = best.iterations;
  for (int i = 0; i < starts; ++i) {
    domain_point at = {p, K(0), K(0)};
    if (i > 1) {  // alternately a corner and the middle of the side after it
      const int k = (i - 2) / 2 * n / corners;
      const domain_vector a = domain_corner(domain, k),
                          b = domain_corner(domain, i % 2 == 0 ? k : wrap(k + 1, n));
      const real part = K(0.375f);  // of their sum
      at.xi = part * (a.xi + b.xi);
      at.eta = part * (a.eta + b.eta);
    }
    // A far one may have two minima in the known patch as well: not every start stops there.
    const int is_far = best.distance2 > rho * rho;
    known_minimum known = {is_far && i <= 1 ? NONE : best.patch, best.distance2};
    const foot start = i == 0 ? first : begin_foot(view, h, at, options);
    const foot f = end_foot(view, h, start, options, known);
    iterations += f.iterations;
    if (best.patch == NONE || is_nearer(f, best)) best = f;
    if (i == 0 && best.distance2 > rho * rho) starts = 2 * corners + 2;
  }
  best.iterations = iterations;
  return best;
}

// The better of a known minimum and that of a patch, if it may be nearer: no point of a patch is
// nearer than its base polygon by more than its sag.
FN foot try_patch(surface_view view, hip_point h, uint patch, track_options options, foot best) {
  GLOBAL scalar* numbers = numbers_of(view, patch);
  const base_point b = base_point_on(view, h, patch);
  const real least = (sqrt(b.at.distance2) - numbers[PATCH_SAG]) * numbers[PATCH_UNSCALE];
  if (least > K(0) && least * least >= best.distance2) return best;
  const foot start = begin_foot(view, h, start_on_base(view, b), options);
  return search_patch(view, h, start, options, best);
}

// Nearest point of the whole surface: from `first`, on the nearest base polygon of all, then from
// every patch whose box is nearer, of those near or, if they are not all, of the surface.
FN_LARGE foot nearest_foot(surface_view view, hip_point h, foot first, const near_patches* near,
                           track_options options) {
  foot best;
  best.patch = NONE;
  best.distance2 = K(0);
  best.iterations = 0;
  best = search_patch(view, h, first, options, best);
  const real rounding = K(64) * EPSILON * best.distance2;
  if (best.distance2 + rounding <= near->complete2) {
    for (int i = 0; i < near->count; ++i) {
      if (near->patch[i] != first.patch && near->box2[i] < best.distance2)
        best = try_patch(view, h, near->patch[i], options, best);
    }
    return best;
  }
  walk w = start_walk(view);
  for (uint p = next_patch(view, &w, h.high, best.distance2); p != NONE;
       p = next_patch(view, &w, h.high, best.distance2)) {
    if (p != first.patch && patch_box_distance2(view, h, p) < best.distance2)
      best = try_patch(view, h, p, options, best);
  }
  return best;
}
