// The three methods behind one interface: what a HIP touches and which force it feels, by
// Algorithm 1.

typedef struct {
  int state;  // CONTACT_FREE or CONTACT_TOUCHING
  int method;
  uint patch;
  real xi, eta;  // domain point of the SCP
  real3 scp;     // surface contact point, local frame
  real3 normal;  // outward surface normal there (of the polygon's blend for shaded and flat), unit
  real3 offset;  // SCP - HIP, mesh frame
  real3 push;  // force over stiffness, mesh frame: `offset`, for shaded turned to the normal; past
               // a border that of its rounded rim (past_border); no number where the surface gives
               // none, though the HIP is near
  real clear;  // of a search: no point of the surface is nearer to the HIP, mesh frame; of
               // tracking 0
  int iterations, crossings;
  uint flags;  // FOOT_*
  // From tick to tick only, never in memory that devices share: the foot's curvature term, and how
  // far the last tick moved the SCP in the patch's domain.
  int warm;  // whether they are there
  sym2 curvature_term;
  domain_vector drift;
  // Points of other parts that a contact on a seam rests against too (union.h).
  int held_count;
  domain_point held[2];
} contact;

#define STORE_ONE(name, member) reals[kContact##name * stride] = c.member;
#define STORE_THREE(name, member) store3(reals + kContact##name * stride, stride, c.member);
#define STORE_WORD(name, member) uints[kContact##name * stride] = (uint)c.member;
// clang-format off
FN void store_contact(GLOBAL_OUT scalar* reals, GLOBAL_OUT uint* uints, ulong stride, contact c) {
  CONTACT_NUMBERS(STORE_ONE, STORE_ONE, STORE_THREE, STORE_THREE, STORE_THREE)
  CONTACT_WORDS(STORE_WORD)
}  // clang-format on

// Unit; that of the base polygon where nothing but rounding is left of the tangent plane.
FN real3 normal_of_foot(surface_view view, foot f) {
  const real3 normal = patch_normal(f.d.at);
  const real longest2 = larger(dot3(f.d.at.g_xi, f.d.at.g_xi), dot3(f.d.at.g_eta, f.d.at.g_eta));
  return SPANS_A_PLANE(norm3(normal), longest2, EPSILON)
             ? unit3(normal)
             : load3(numbers_of(view, f.patch), PATCH_NORMAL);
}

// The angle between two directions, by sqrt alone: of its sixteenth the sine, and from that the
// angle to 1e-7.
FN real angle_between(real3 a, real3 b) {
  const real3 u = unit3(a), v = unit3(b);
  real sine = norm3(sub3(u, v)) / K(2), cosine = norm3(add3(u, v)) / K(2);
  for (int i = 0; i < 3; ++i) {
    cosine = sqrt((K(1) + cosine) / K(2));
    sine /= K(2) * cosine;
  }
  const real s2 = sine * sine;
  return K(16) * sine * fma(s2, fma(s2, fma(s2, K(5) / K(112), K(3) / K(40)), K(1) / K(6)), K(1));
}

// The normal of the corner at which `side` starts, its length the angle there.
FN real3 corner_normal(surface_view view, uint side, effort* spent) {
  const corner_tangents t = tangents_at(view, side, spent);
  const real3 across = cross3(t.p, t.q);
  // Where a crease goes on through the corner, its tangents are one and say nothing.
  const int is_straight = HAS_CREASES(view) && norm3(across) <= K(1e-5f) * norm3(t.p) * norm3(t.q);
  return mul3(angle_between(t.p, t.q),
              is_straight ? load3(view.corner + 6 * (ulong)side, 1) : unit3(across));
}

// The normal at a foot that is held by an edge or a corner with several normals: their sum, at a
// corner by angle. It tells inside from outside whichever of the patches the foot belongs to
// (Baerentzen and Aanaes 2005).
FN_LARGE real3 crease_normal(surface_view view, foot f, effort* spent) {
  const int n = valence_of(view, f.patch);
  const held_sides held = sides_at(domain_of(view, n), n, f.d.xi, f.d.eta);
  const real3 own = normal_of_foot(view, f);
  real3 sum = own;
  if (held.b >= 0) {
    const uint start = view.side_begin[f.patch] + (uint)held.b;
    sum = corner_normal(view, start, spent);
    fan_walk fan = start_fan(start);
    for (uint at = next_in_fan(view, &fan); at != NONE; at = next_in_fan(view, &fan))
      sum = add3(sum, corner_normal(view, at, spent));
  } else if (held.a >= 0) {
    const uint side = view.side_begin[f.patch] + (uint)held.a, twin = view.side_twin[side];
    if (twin == NONE) return own;
    const domain_point to = cross_edge(view, side, twin, f.d.xi, f.d.eta);
    foot beyond = f;
    beyond.patch = to.patch;
    beyond.d.at = evaluate_aside(view, to, spent);
    sum = add3(sum, normal_of_foot(view, beyond));
  }
  return norm3(sum) > K(0x1p-10f) ? unit3(sum) : own;
}

// Past an open border the surface has no force to give, yet what slid over it must not be let go at
// once. So a border is rounded off as the rim of a solid is: with the depth `d` under the tangent
// plane and the way `s` past the border, the HIP is pushed along the gradient of (d^2 - s^2) / 2,
// and from s = d / 2 on along that of 2 (d - s / 2)^2 / 3, which fades to nothing at s = 2 d. The
// push changes by at most 5/3 of the HIP's way. `normal` is the surface's at the border.
FN contact past_border(contact c, real3 normal) {
  const real depth = dot3(c.offset, normal);
  const real3 aside = fma3(-depth, normal, c.offset);
  const real past = norm3(aside);
  c.state = past < K(2) * depth ? CONTACT_TOUCHING : CONTACT_FREE;
  if (c.state == CONTACT_FREE) return c;
  if (K(2) * past <= depth) {
    c.push = fma3(depth, normal, mul3(-K(1), aside));
  } else {
    const real pressed = K(4) / K(3) * (depth - past / K(2));
    c.push = fma3(pressed, normal, mul3(-pressed / (K(2) * past), aside));
  }
  return c;
}

// A converged contact at a point of a patch, whose state is still to be judged.
FN contact contact_at(int method, uint patch, real xi, real eta, real3 scp, real3 normal,
                      real3 offset) {
  contact c;
  c.state = CONTACT_FREE;
  c.method = method;
  c.patch = patch;
  c.xi = xi;
  c.eta = eta;
  c.scp = scp;
  c.normal = normal;
  c.offset = c.push = offset;
  c.clear = K(0);
  c.iterations = 0;
  c.crossings = 0;
  c.flags = FOOT_CONVERGED;
  c.warm = 0;
  c.held_count = 0;
  return c;
}

FN contact contact_of_foot(surface_view view, foot f, effort* spent) {
  const real3 normal =
      f.flags & FOOT_CREASE ? crease_normal(view, f, spent) : normal_of_foot(view, f);
  contact c = contact_at(METHOD_GREGORY, f.patch, f.d.xi, f.d.eta, f.d.at.g, normal,
                         mul3(numbers_of(view, f.patch)[PATCH_UNSCALE], f.d.r));
  c.clear = sqrt(f.clear2);
  c.crossings = f.crossings;
  c.flags = f.flags | (f.d.converged ? (uint)FOOT_CONVERGED : 0u);
  c.warm = 1;
  c.curvature_term = f.d.curvature_term;
  c.drift = make_vector(K(0), K(0));
  // Inside where the way out goes along the normal. Where folds make that wrong the host corrects
  // it (correct_state of host/query/frames.h).
  c.state = dot3(f.d.r, c.normal) > K(0) ? CONTACT_TOUCHING : CONTACT_FREE;
  return f.flags & FOOT_BORDER ? past_border(c, c.normal) : c;
}

// True if a point of the polygons lies on an open border.
FN int is_on_border(surface_view view, base_point b) {
  const polygon_sides s = polygon_of(view, b.patch, b.whole);
  const polygon_place place = place_on_polygon(s.n, b.at);
  if (place.side >= 0) return view.side_twin[s.first + (uint)place.side * s.stride] == NONE;
  return place.corner >= 0 && is_border_vertex(view, s.first + (uint)place.corner * s.stride);
}

// The unit normal of a triangle of a polygon.
FN real3 triangle_normal(surface_view view, uint patch, polygon_sides s, triangle_corners c) {
  const real3 a = polygon_corner(view, patch, s, c.i);
  const real3 normal = cross3(sub3(polygon_corner(view, patch, s, c.j), a),
                              sub3(polygon_corner(view, patch, s, c.k), a));
  return norm3(normal) > TINY ? unit3(normal) : load3(numbers_of(view, patch), PATCH_NORMAL);
}

// Returns the normal of the triangle with an edge from corner `from` to `to`; zero without one.
FN_LARGE real3 normal_beside(surface_view view, uint patch, int from, int to) {
  const polygon_sides s = polygon_of(view, patch, 1);
  for (int t = 0; t < s.triangles; ++t) {
    int own = t;
    const uint holder = holder_of(view, s, patch, &own);
    const triangle_corners c = triangle_of(view, holder, own, 1);
    if ((c.i == from && c.j == to) || (c.j == from && c.k == to) || (c.k == from && c.i == to))
      return triangle_normal(view, patch, s, c);
  }
  return zero3();
}

// The sum of the normals of the triangles of a polygon at a corner of it, by their angles there.
FN_LARGE real3 normals_at(surface_view view, uint patch, polygon_sides s, int corner) {
  const real3 at = polygon_corner(view, patch, s, corner);
  real3 sum = zero3();
  for (int t = 0; t < s.triangles; ++t) {
    int own = t;
    const uint holder = holder_of(view, s, patch, &own);
    const triangle_corners c = triangle_of(view, holder, own, 1);
    if ((c.i != corner && c.j != corner && c.k != corner) || c.i == c.j) continue;
    const int a = c.i == corner   ? c.j
                  : c.j == corner ? c.k
                                  : c.i,
              b = c.i == corner   ? c.k
                  : c.j == corner ? c.i
                                  : c.j;
    const real angle = angle_between(sub3(polygon_corner(view, patch, s, a), at),
                                     sub3(polygon_corner(view, patch, s, b), at));
    sum = fma3(angle, triangle_normal(view, patch, s, c), sum);
  }
  return sum;
}

// The outward normal of the polygons at a point of theirs, unit: of its triangle, or the sum of
// those that meet there, at a corner by angle. It tells inside from outside (Baerentzen and Aanaes
// 2005), whatever the vertex normals are.
FN_LARGE real3 polygon_normal(surface_view view, base_point b) {
  const polygon_sides s = polygon_of(view, b.patch, 1);
  const triangle_place place = place_on_triangle(b.at);
  const triangle_corners own = {b.at.i, b.at.j, b.at.k};
  if (place.corner >= 0) {
    const uint start = s.first + (uint)place.corner * s.stride;
    real3 sum = normals_at(view, b.patch, s, place.corner);
    fan_walk fan = start_fan(start);
    for (uint at = next_in_fan(view, &fan); at != NONE; at = next_in_fan(view, &fan)) {
      const uint patch = view.side_patch[at];
      const polygon_sides beside = polygon_of(view, patch, 1);
      const uint from_first = at - beside.first;
      if (from_first % beside.stride == 0)  // else it leads to the centre
        sum = add3(sum, normals_at(view, patch, beside, (int)(from_first / beside.stride)));
    }
    return unit3(sum);
  }
  const real3 normal = triangle_normal(view, b.patch, s, own);
  if (place.from < 0) return normal;
  if (wrap(place.from + 1, s.n) != place.to)  // a diagonal
    return unit3(add3(normal, normal_beside(view, b.patch, place.to, place.from)));
  const uint twin = view.side_twin[s.first + (uint)place.from * s.stride];
  if (twin == NONE) return normal;
  const uint patch = view.side_patch[twin];
  const polygon_sides beside = polygon_of(view, patch, 1);
  const int k = (int)((twin - beside.first) / beside.stride);
  return unit3(add3(normal, normal_beside(view, patch, k, wrap(k + 1, beside.n))));
}

// The contact at a point of the polygons themselves.
FN contact contact_of_base(surface_view view, hip_point h, base_point b, polygon_blend blend,
                           int method) {
  const real3 r = sub3(b.at.p, local_hip(view, h, b.patch)), normal = polygon_normal(view, b);
  contact c = contact_at(method, b.patch, blend.xi, blend.eta, b.at.p, unit3(blend.normal),
                         mul3(numbers_of(view, b.patch)[PATCH_UNSCALE], r));
  c.state = dot3(r, normal) > K(0) ? CONTACT_TOUCHING : CONTACT_FREE;
  if (is_on_border(view, b)) {
    c.flags |= FOOT_BORDER;
    c = past_border(c, normal);
  }
  if (method == METHOD_SHADED) c.push = mul3(norm3(c.push), c.normal);
  return c;
}

// A thousand sizes of the mesh away, rounding of the offset may be more than parts are thick.
#define FAR_OUTSIDE K(1024)

// Ends a query's contact: beyond FAR_OUTSIDE there is none. Nearer, a number that is not finite
// means that the surface's data are bad. The push is then NaN, so that nobody mistakes it for "no
// force".
FN contact within_reach(hip_point h, contact c) {
  const real reach = reach_of_hip(h);
  const real3 all = add3(add3(c.scp, c.normal), add3(c.offset, c.push));
  const real sum = all.x + all.y + all.z;
  if (!(reach <= FAR_OUTSIDE)) {
    c.state = CONTACT_FREE;
    c.push = make3(K(0), K(0), K(0));
  } else if (!(sum - sum == K(0))) {
    c.state = CONTACT_FREE;
    c.push = make3(K(NAN), K(NAN), K(NAN));
  }
  if (!(reach - reach == K(0))) c.flags &= ~FOOT_CONVERGED;  // it is no place
  return c;
}

// Tells a contact, the last of its query, what that has spent. Its iterations are the evaluations
// at feet after the first. They leave out those for tangents and normals of corners and creases,
// for a step that was refused and for the paper's secants.
FN void tell(contact* c, const effort* spent) {
  PROMISE(spent->steps <= spent->evaluations);
  c->iterations = spent->steps > 0 ? spent->steps - 1 : 0;
  if (spent->is_cut) c->flags |= FOOT_UNFINISHED;
}

// Carry a contact found on one part to the union of all (union.h).
FN_ONCE contact unite_nearest(surface_view view, hip_point h, contact c, track_options options);
FN_LARGE contact unite_tracked(surface_view view, hip_point h, contact last, contact c,
                               track_options options);

FN_LARGE contact nearest_contact_from(surface_view view, hip_point h, const foot* first,
                                      const near_patches* near, track_options options) {
  const foot f = nearest_foot(view, h, first, near, options);
  contact c = within_reach(h, contact_of_foot(view, f, options.spent));
  if (HAS_UNION(view)) c = unite_nearest(view, h, c, options);
  return c;
}

// `base`: of the polygons, or else of the patches'.
FN contact nearest_contact_of_base(surface_view view, hip_point h, base_point base,
                                   polygon_blend blend, int method) {
  if (HAS_FANS(view) && !base.whole) {
    near_patches near;
    base = nearest_base(view, h, base.patch, 0, &near);
    blend = blend_on_polygon(view, base);
  }
  base.whole = 1;
  contact c = contact_of_base(view, h, base, blend, method);
  c.clear = norm3(c.offset);
  return within_reach(h, c);
}

// Global: the nearest point of the surface, given that of the base polygons and its blend.
FN_LARGE contact nearest_contact(surface_view view, hip_point h, base_point base,
                                 polygon_blend blend, const near_patches* near, int method,
                                 track_options options) {
  if (method != METHOD_GREGORY) return nearest_contact_of_base(view, h, base, blend, method);
  const foot first = begin_foot(view, h, start_at(base.patch, blend), options);
  return nearest_contact_from(view, h, &first, near, options);
}

FN_LARGE contact track_contact_from(surface_view view, hip_point h, contact last, foot* f,
                                    track_options options) {
  const known_minimum none = {NONE, K(0)};
  end_foot(view, h, f, options, none);
  contact c = within_reach(h, contact_of_foot(view, *f, options.spent));
  if (HAS_UNION(view) && options.max_iterations > 0) c = unite_tracked(view, h, last, c, options);
  return c;
}

// Local: the point that `last` was, after the HIP has moved to h. Without iterations it stays where
// it was on its part.
FN_LARGE contact track_contact(surface_view view, hip_point h, contact last,
                               track_options options) {
  if (last.method != METHOD_GREGORY) {
    const base_point base = track_base(view, h, last.patch, options.max_iterations);
    const polygon_blend blend = blend_on_polygon(view, base);
    return within_reach(h, contact_of_base(view, h, base, blend, last.method));
  }
  const domain_point at = {last.patch, last.xi, last.eta};
  foot f = begin_foot(view, h, at, options);
  return track_contact_from(view, h, last, &f, options);
}

// Where the contact would be had it gone on as in the last tick; where it was, if that is outside.
FN domain_point ahead_of(surface_view view, contact last) {
  const int n = valence_of(view, last.patch);
  domain_point r = {last.patch, last.xi, last.eta};
  const domain_vector ahead = make_vector(last.xi + last.drift.xi, last.eta + last.drift.eta);
  if (is_inside(domain_of(view, n), n, ahead)) {
    r.xi = ahead.xi;
    r.eta = ahead.eta;
  }
  return r;
}

// As track_contact after a tick that was in contact as well: starts from where the SCP was going,
// with the curvature found on the way.
FN_LARGE contact follow_contact(surface_view view, hip_point h, contact last,
                                track_options options) {
  const known_minimum none = {NONE, K(0)};
  track_options brief = options;
  brief.max_iterations = options.max_iterations < 8 ? options.max_iterations : 8;
  foot f = start_foot(view, h, ahead_of(view, last), options.spent);
  f.d.curvature_term = last.curvature_term;
  track_foot(view, h, &f, brief, none);
  if (may_be_top(view, &f)) leave_top(view, h, &f, options, none);
  if (!f.d.converged)  // the hand did something else
    return track_contact(view, h, last, options);
  contact c = within_reach(h, contact_of_foot(view, f, options.spent));
  if (HAS_UNION(view)) c = unite_tracked(view, h, last, c, options);
  if (c.patch == last.patch) c.drift = make_vector(c.xi - last.xi, c.eta - last.eta);
  return c;
}

// A tick, Algorithm 1: free, search everywhere; in contact, follow it until the HIP is outside
// again. Outside there is no force.
FN contact tick(surface_view view, hip_point h, contact last, track_options options) {
  if (last.state != CONTACT_TOUCHING) {
    near_patches near;
    const base_point base = nearest_base(view, h, last.patch, last.method == METHOD_GREGORY, &near);
    const polygon_blend blend = blend_on_polygon(view, base);
    return nearest_contact(view, h, base, blend, &near, last.method, options);
  }
  return last.warm && options.solver == SOLVER_NEWTON ? follow_contact(view, h, last, options)
                                                      : track_contact(view, h, last, options);
}
