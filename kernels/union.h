// Parts that overlap or touch are a union of solids. A foot of one part that lies inside another is
// buried: the contact then lies on the seam of both, a concave crease, or elsewhere on the union's
// surface. On a seam the contact is the point nearest to the HIP among those outside of the tangent
// planes at its feet on two or three parts; these are taken anew at each point found, until that
// stays.

// A point of a part that the contact may rest against.
typedef struct {
  foot at;       // of the HIP moved by the push before this one
  real3 normal;  // outward, unit
  real3 out;     // point - HIP, mesh frame
  real weight;   // of its normal in the push
} union_support;

#define UNION_SUPPORTS 4
#define UNION_STEPS 48  // at most, to relax
typedef struct {
  int count;
  union_support support[UNION_SUPPORTS];
  real3 push;   // contact point - HIP, mesh frame
  int state;    // CONTACT_*, or UNION_LOST
  foot only;    // of the HIP, where there is one support
  real3 known;  // push of the nearest contact point found before
  real known2;  // its square; INFINITY: there is none
  uint beside;  // the patch last found on a burying part; NONE: there is none
} union_search;
#define UNION_LOST 2

// Burial is judged this far outside of a surface, mesh frame, so that faces of two parts that touch
// bury each other.
#define UNION_GAP (sizeof(scalar) == 4 ? K(0x1p-17f) : K(0x1p-32f))

FN int is_exposed(surface_view view, uint patch) {
  return !(view.part[patch] & (PATCH_BURIED | PATCH_MIXED));
}

// The HIP moved, with what high parts cannot hold in the low ones.
FN real moved_low(real high, real low, real by) {
  const real sum = high + by, part = sum - high;
  return low + ((high - (sum - part)) + (by - part));
}
FN hip_point moved_hip(hip_point h, real3 by) {
  hip_point r;
  r.high = add3(h.high, by);
  r.low = make3(moved_low(h.high.x, h.low.x, by.x), moved_low(h.high.y, h.low.y, by.y),
                moved_low(h.high.z, h.low.z, by.z));
  return r;
}

FN int is_within(surface_view view, foot f, effort* spent) {
  return contact_of_foot(view, f, spent).state == CONTACT_TOUCHING;
}

// True, once and for all, where the budget ends a search.
FN int is_cut(effort* spent) {
  spent->is_cut = spent->is_cut || is_spent(spent);
  return spent->is_cut;
}

// Answers to whether a point lies in a solid part. Unknown: the budget has ended the search.
#define BURIED_NO 0
#define BURIED_YES 1
#define BURIED_UNKNOWN 2

// True if the patch of a base polygon, whose nearest point is known, may hold a nearer one than
// `distance2`.
FN int may_hold_nearer(surface_view view, base_point b, real distance2) {
  GLOBAL scalar* numbers = numbers_of(view, b.patch);
  const real least = (sqrt(b.at.distance2) - numbers[PATCH_SAG]) * numbers[PATCH_UNSCALE];
  return !(least > K(0) && least * least >= distance2);
}

// Goes on with the nearest point of a part on another patch of it, from one start.
FN foot try_patch_of_part(surface_view view, hip_point h, uint patch, foot best,
                          track_options options) {
  const base_point b = base_point_on(view, h, patch, 0);
  if (!may_hold_nearer(view, b, best.d.distance2)) return best;
  const known_minimum known = {best.patch, best.d.distance2};
  foot f = begin_foot(view, h, start_on_base(view, b), options);
  end_foot(view, h, &f, options, known);
  return is_nearer(f, best) ? f : best;
}

// Nearest point of one part's surface: each patch is searched from one start, which tells inside
// from outside well enough far from a surface as well. Any point of it where the budget ends the
// search. `beside`: the patch last found so, or NONE.
FN_LARGE foot nearest_on_part(surface_view view, hip_point h, uint part, uint* beside,
                              track_options options) {
  const int is_beside = *beside != NONE && part_of(view, *beside) == part;
  const uint guess = is_beside ? *beside : view.part_table[PART_UINTS * part + PART_FIRST];
  near_patches near;
  const base_point base = nearest_base_of(view, h, guess, part, 1, &near);
  *beside = base.patch;
  const known_minimum none = {NONE, K(0)};
  foot best = begin_foot(view, h, start_on_base(view, base), options);
  end_foot(view, h, &best, options, none);
  if (best.d.distance2 <= near.complete2) {
    for (int i = 0; i < near.count && near.box2[i] < best.d.distance2; ++i) {
      if (near.patch[i] != base.patch && !is_cut(options.spent))
        best = try_patch_of_part(view, h, near.patch[i], best, options);
    }
    return best;
  }
  walk w = start_walk(view);
  for (uint p = next_patch(view, &w, h.high, best.d.distance2); p != NONE && !is_cut(options.spent);
       p = next_patch(view, &w, h.high, best.d.distance2)) {
    if (p != base.patch && part_of(view, p) == part &&
        patch_box_distance2(view, h, p) < best.d.distance2)
      best = try_patch_of_part(view, h, p, best, options);
  }
  return best;
}

FN int in_part_box(surface_view view, hip_point h, uint part) {
  return !(box_distance2(view.part_box + 6 * (ulong)part, h.high) > K(0));
}

// Says whether a point lies in a solid part (BURIED_*), as a search of its surface tells.
FN int is_in_part(surface_view view, foot nearest, effort* spent) {
  if (spent->is_cut) return BURIED_UNKNOWN;
  return is_within(view, nearest, spent) ? BURIED_YES : BURIED_NO;
}

// Says whether a point lies in a solid part that may hold points of a patch.
FN_LARGE int is_in_partner(surface_view view, hip_point h, uint patch, uint* beside,
                           track_options options) {
  GLOBAL uint* table = view.part_table + PART_UINTS * (ulong)part_of(view, patch);
  for (uint i = table[PART_PARTNERS]; i < table[PART_PARTNERS_END]; ++i) {
    const uint part = view.partner[i];
    if (!in_part_box(view, h, part)) continue;
    if (is_cut(options.spent)) return BURIED_UNKNOWN;
    const foot f = nearest_on_part(view, h, part, beside, options);
    const int answer = is_in_part(view, f, options.spent);
    if (answer != BURIED_NO) return answer;
  }
  return BURIED_NO;
}

// The foot of the HIP moved by `push`. Held by an edge or corner, the way out is that to the point.
FN union_support support_of(surface_view view, foot f, real3 push, track_options options) {
  const real unscale = numbers_of(view, f.patch)[PATCH_UNSCALE];
  union_support r;
  r.at = f;
  r.normal = normal_of_foot(view, f);
  r.out = fma3(unscale, f.d.r, push);
  r.weight = K(0);
  const real length = norm3(f.d.r);
  if ((f.flags & (FOOT_CREASE | FOOT_BORDER)) && length > K(1024) * options.tolerance)
    r.normal = mul3((is_within(view, f, options.spent) ? K(1) : K(-1)) / length, f.d.r);
  return r;
}

// Says whether a solid part buries the contact point, as seen from a patch that it lies on with an
// outward direction there, and adds a support on it. With adds_nearest the nearest part that does
// not bury it is added instead where none does.
FN_LARGE int join_burier(surface_view view, hip_point h, uint patch, real3 outward, union_search* u,
                         int adds_nearest, track_options options) {
  if (is_exposed(view, patch) || u->count == UNION_SUPPORTS) return BURIED_NO;
  const real3 push = fma3(UNION_GAP, outward, u->push);
  const hip_point x = moved_hip(h, push);
  GLOBAL uint* table = view.part_table + PART_UINTS * (ulong)part_of(view, patch);
  real nearest2 = -K(1);
  for (uint i = table[PART_PARTNERS]; i < table[PART_PARTNERS_END]; ++i) {
    const uint part = view.partner[i];
    int is_held = !in_part_box(view, x, part);
    for (int k = 0; k < u->count; ++k)
      is_held = is_held || part_of(view, u->support[k].at.patch) == part;
    if (is_held) continue;
    if (is_cut(options.spent)) return BURIED_UNKNOWN;
    const foot f = nearest_on_part(view, x, part, &u->beside, options);
    const int answer = is_in_part(view, f, options.spent);
    if (answer == BURIED_YES) u->support[u->count++] = support_of(view, f, push, options);
    if (answer != BURIED_NO) return answer;
    if (adds_nearest && (nearest2 < K(0) || f.d.distance2 < nearest2)) {
      nearest2 = f.d.distance2;
      u->support[u->count] = support_of(view, f, push, options);
    }
  }
  if (nearest2 >= K(0)) ++u->count;
  return BURIED_NO;
}

FN int clears_supports(const union_search* u, real3 push) {
  for (int i = 0; i < u->count; ++i) {
    const real3 n = u->support[i].normal;
    const real needed = dot3(n, u->support[i].out);
    const real slack = K(256) * EPSILON * (norm3(push) + fabs(needed));
    if (!(dot3(n, push) >= needed - slack)) return 0;
  }
  return 1;
}

// The push out of the planes of two supports, which it rests on; false where those are nearly one,
// do not both press, or others hold it.
FN int push_of_two(union_search* u, int i, int j, real3* push) {
  const real3 n = u->support[i].normal, m = u->support[j].normal;
  const real b = dot3(n, u->support[i].out), c = dot3(m, u->support[j].out), along = dot3(n, m);
  const real3 across = cross3(n, m);
  const real apart = dot3(across, across);
  if (!(apart > K(0x1p-24f))) return 0;
  const real v = (b - along * c) / apart, w = (c - along * b) / apart;
  *push = fma3(v, n, mul3(w, m));
  if (!(v > K(0) && w > K(0) && clears_supports(u, *push))) return 0;
  u->support[i].weight = v;
  u->support[j].weight = w;
  return 1;
}

// The same out of those of three.
FN int push_of_three(union_search* u, int i, int j, int k, real3* push) {
  const real3 a = u->support[i].normal, b = u->support[j].normal, c = u->support[k].normal;
  const real3 bc = cross3(b, c), ca = cross3(c, a), ab = cross3(a, b);
  const real det = dot3(a, bc);
  if (!(det * det > K(0x1p-24f))) return 0;
  const real over = K(1) / det;
  *push =
      mul3(over, fma3(dot3(a, u->support[i].out), bc,
                      fma3(dot3(b, u->support[j].out), ca, mul3(dot3(c, u->support[k].out), ab))));
  const real v = over * dot3(*push, bc), w = over * dot3(*push, ca), x = over * dot3(*push, ab);
  if (!(v > K(0) && w > K(0) && x > K(0) && clears_supports(u, *push))) return 0;
  u->support[i].weight = v;
  u->support[j].weight = w;
  u->support[k].weight = x;
  return 1;
}

// The shortest push out of all tangent planes, and the weights of those that it rests on; false
// where there is none.
FN_LARGE int shortest_push(union_search* u, real3* push) {
  const real none = K(0);
  int pressed = 0;
  for (int i = 0; i < u->count; ++i) {
    u->support[i].weight = none;
    pressed += dot3(u->support[i].normal, u->support[i].out) > none;
  }
  *push = make3(none, none, none);
  if (pressed == 0) return 1;
  for (int i = 0; i < u->count; ++i) {
    const real3 n = u->support[i].normal;
    const real b = dot3(n, u->support[i].out);
    *push = mul3(b, n);
    if (b > none && clears_supports(u, *push)) {
      u->support[i].weight = b;
      return 1;
    }
  }
  for (int i = 0; i < u->count; ++i) {
    for (int j = i + 1; j < u->count; ++j) {
      if (push_of_two(u, i, j, push)) return 1;
    }
  }
  for (int skip = u->count - 1; u->count >= 3 && skip >= (u->count == 4 ? 0 : 2); --skip) {
    // All but one of four; the first three of three.
    const int left = u->count == 4 ? skip : 3;
    const int i = left == 0 ? 1 : 0, j = left <= 1 ? 2 : 1, k = left <= 2 ? 3 : 2;
    if (push_of_three(u, i, j, k, push)) return 1;
  }
  return 0;
}

FN int count_pressed(const union_search* u) {
  int count = 0;
  for (int i = 0; i < u->count; ++i) count += u->support[i].weight > K(0);
  return count;
}
FN void keep_pressed(union_search* u) {
  int count = 0;
  for (int i = 0; i < u->count; ++i) {
    if (u->support[i].weight > K(0)) u->support[count++] = u->support[i];
  }
  u->count = count;
}

// Along the seam of the two that are pressed.
FN real3 along_seam(const union_search* u) {
  int first = -1, second = -1;
  for (int i = 0; i < u->count; ++i) {
    if (!(u->support[i].weight > K(0))) continue;
    if (first < 0) first = i;
    second = i;
  }
  return unit3(cross3(u->support[first].normal, u->support[second].normal));
}

// The domain point of a foot, and that point as a foot of another HIP. One of -1 evaluations is a
// place, not evaluated yet.
FN domain_point point_of(foot f) {
  domain_point r = {f.patch, f.d.xi, f.d.eta};
  return r;
}
FN foot foot_seen_from(surface_view view, hip_point h, foot f, track_options options) {
  if (f.d.evaluations < K(0)) {
    f = begin_foot(view, h, point_of(f), options);
    f.d.evaluations = K(1);
    return f;
  }
  begin_foot_of(&f, f.patch);
  begin_descent(&f.d);
  move_descent(&f.d, make_vector(f.d.xi, f.d.eta), f.d.at, local_hip(view, h, f.patch),
               numbers_of(view, f.patch)[PATCH_UNSCALE]);
  options.spent->fan_begin = options.spent->fan_steps;
  f.d.curvature_term = start_curvature_term(view, f, options);
  return f;
}

// Moves the supports towards the feet of the HIP moved by the push, by as many steps each as
// options say; true if they are there. After one step their planes are as good as the push is.
FN int move_supports(surface_view view, hip_point h, union_search* u, track_options options) {
  const hip_point x = moved_hip(h, u->push);
  const known_minimum none = {NONE, K(0)};
  int are_there = 1;
  for (int i = 0; i < u->count; ++i) {
    const real weight = u->support[i].weight;
    foot f = foot_seen_from(view, x, u->support[i].at, options);
    end_foot(view, x, &f, options, none);
    are_there = are_there && f.d.converged;
    u->support[i] = support_of(view, f, u->push, options);
    u->support[i].weight = weight;
  }
  return are_there;
}

// Says whether another part buries the contact on a seam, and adds its support.
FN int is_seam_buried(surface_view view, hip_point h, union_search* u, track_options options) {
  if (u->count == UNION_SUPPORTS) keep_pressed(u);
  const int count = u->count;
  const real3 outward = unit3(u->push);
  for (int i = 0; i < count; ++i) {
    if (!(u->support[i].weight > K(0))) continue;
    const int answer = join_burier(view, h, u->support[i].at.patch, outward, u, 0, options);
    if (answer != BURIED_NO) return answer;
  }
  return BURIED_NO;
}

// With one part pressed the contact is the HIP's own foot on it. False if another part buries that:
// its support is added. It is kept where that is unknown.
FN int relax_on_one(surface_view view, hip_point h, union_search* u, track_options options) {
  const known_minimum none = {NONE, K(0)};
  keep_pressed(u);
  u->only = foot_seen_from(view, h, u->support[0].at, options);
  end_foot(view, h, &u->only, options, none);
  if (u->only.d.distance2 > u->known2) return 1;  // nor is anything nearer that it leads to
  u->support[0] = support_of(view, u->only, make3(K(0), K(0), K(0)), options);
  u->push = u->support[0].out;
  u->state = is_within(view, u->only, options.spent) ? CONTACT_TOUCHING : CONTACT_FREE;
  if (u->state == CONTACT_FREE || join_burier(view, h, u->support[0].at.patch, u->support[0].normal,
                                              u, 0, options) != BURIED_YES)
    return 1;
  u->state = UNION_LOST;
  return 0;
}

// True if a search whose last step had this length ends at the contact point that is known, or
// farther away: steps shrink.
FN int leads_nowhere_new(const union_search* u, real length) {
  const real3 apart = sub3(u->push, u->known);
  const real nearest = norm3(u->push) - K(4) * length;
  return (nearest > K(0) && nearest * nearest > u->known2) ||
         K(64) * dot3(apart, apart) < length * length;
}

// True if `out` of each support is the way from the HIP to its point: what planes are made of.
FN int are_seen_from(surface_view view, hip_point h, const union_search* u) {
  for (int i = 0; i < u->count; ++i) {
    const foot f = u->support[i].at;
    const real unscale = numbers_of(view, f.patch)[PATCH_UNSCALE];
    const real3 out = mul3(unscale, sub3(f.d.at.g, local_hip(view, h, f.patch)));
    const real error = norm3(sub3(out, u->support[i].out));
    if (!(error <= K(1024) * EPSILON * (reach_of_hip(h) + K(1)))) return 0;
  }
  return 1;
}

// The secant along the seam of two parts, whose curvature their planes do not know.
typedef struct {
  real slope, step;  // the last ones; no step: there is none
  int pressed;       // parts that were pressed then
} seam_secant;

// The push of two planes and a step along their seam, at most so long.
FN real3 push_along_seam(const union_search* u, real3 push, real most, seam_secant* s) {
  const real3 along = along_seam(u);
  const real slope = dot3(along, u->push);
  real secant = K(1);
  if (s->step != K(0)) {
    // In the middle of a round seam it is hardly bent, as seen from the HIP.
    secant = fabs((slope - s->slope) / s->step);
    secant = smaller(larger(secant, K(0x1p-7f)), K(4));
  }
  s->slope = slope;
  s->step = smaller(larger(-slope / secant, -most), most);
  return fma3(slope + s->step, along, push);
}

// From supports and a push to a contact point that no part buries; it is given up where what is
// known is as near.
FN_LARGE void relax(surface_view view, hip_point h, union_search* u, track_options options) {
  seam_secant seam = {K(0), K(0), 0};
  real3 before = u->push, mark = u->push;
  track_options brief = options;
  brief.max_iterations = options.max_iterations < 1 ? options.max_iterations : 1;
  u->state = UNION_LOST;
  for (int i = 0; i < UNION_STEPS && !is_cut(options.spent); ++i) {
    PROMISE(are_seen_from(view, h, u));
    // Back by a long step to where it was: it goes round (Brent 1980).
    if (K(16) * norm3(sub3(u->push, mark)) < norm3(sub3(u->push, before))) return;
    if ((i & (i - 1)) == 0) mark = u->push;
    before = u->push;
    real3 push;
    if (!shortest_push(u, &push)) return;
    const int pressed = count_pressed(u);
    if (pressed != seam.pressed) seam.step = K(0);
    seam.pressed = pressed;
    if (pressed == 0) u->state = CONTACT_FREE;
    if (pressed == 0 || (pressed == 1 && relax_on_one(view, h, u, options))) return;
    if (pressed == 1) continue;
    // A patch away the surfaces are others, and the seam.
    const real most = numbers_of(view, u->support[0].at.patch)[PATCH_UNSCALE];
    const int is_guess = pressed == 2 && seam.step == K(0);  // that step may be far too short
    if (pressed == 2) push = push_along_seam(u, push, most / K(2), &seam);
    const real3 step = sub3(push, u->push);
    const real length = norm3(step);
    if (length > most) {
      push = add3(u->push, mul3(most / length, step));
      seam.step = K(0);
    }
    u->push = push;
    const int are_there = move_supports(view, h, u, brief);
    if (!is_guess && leads_nowhere_new(u, length)) return;
    const real close =
        larger(options.tolerance * numbers_of(view, u->support[0].at.patch)[PATCH_UNSCALE],
               K(16) * EPSILON * norm3(push));
    if (length > close) continue;
    if (!are_there && !move_supports(view, h, u, options)) return;
    if (!are_there) continue;
    if (is_seam_buried(view, h, u, options) == BURIED_YES) {
      seam.pressed = 0;
      continue;
    }
    keep_pressed(u);
    u->state = CONTACT_TOUCHING;
    return;
  }
}

// Touching; on a seam, that of the part pressed most.
FN contact contact_of_union(surface_view view, hip_point h, const union_search* u, effort* spent) {
  contact c;
  if (u->count == 1) {
    c = contact_of_foot(view, u->only, spent);
  } else {
    int most = 0;
    for (int i = 1; i < u->count; ++i) {
      if (u->support[i].weight > u->support[most].weight) most = i;
    }
    const foot at = u->support[most].at;
    c = contact_at(METHOD_GREGORY, at.patch, at.d.xi, at.d.eta, at.d.at.g, unit3(u->push), u->push);
    c.clear = norm3(u->push);
    c.flags |= FOOT_CREASE;
    for (int i = 0; i < u->count; ++i) {
      if (i != most && c.held_count < 2) c.held[c.held_count++] = point_of(u->support[i].at);
    }
  }
  c.state = CONTACT_TOUCHING;
  return within_reach(h, c);
}

FN union_search start_union(void) {
  union_search u;
  u.count = 0;
  u.state = UNION_LOST;
  u.known = make3(K(INFINITY), K(INFINITY), K(INFINITY));
  u.known2 = K(INFINITY);
  u.beside = NONE;
  return u;
}
FN union_search start_union_at(contact c) {
  union_search u = start_union();
  u.count = 1;
  begin_foot_of(&u.support[0].at, c.patch);
  u.support[0].at.d.evaluations = K(-1);
  u.support[0].at.d.xi = c.xi;
  u.support[0].at.d.eta = c.eta;
  u.support[0].at.d.at.g = c.scp;
  u.support[0].normal = c.normal;
  u.support[0].out = u.push = c.offset;
  u.support[0].weight = K(1);
  return u;
}

// Takes the contact point that a search has found for the nearest that is known.
FN void know_push(union_search* u) {
  u->known = u->push;
  u->known2 = dot3(u->push, u->push);
}

// Seeks the nearest point on one patch, or on the seams there, for a HIP inside: from the point of
// its base polygon that is nearest to the HIP.
FN_LARGE void seek_on_patch(surface_view view, hip_point h, base_point base, union_search* u,
                            track_options options) {
  const foot first = begin_foot(view, h, start_on_base(view, base), options);
  u->count = 1;
  u->state = UNION_LOST;
  if (is_exposed(view, base.patch)) {
    const known_minimum none = {NONE, K(0)};
    u->only = first;
    end_foot(view, h, &u->only, options, none);
    u->only = search_patch(view, h, base.patch, options, u->only);
    u->support[0] = support_of(view, u->only, make3(K(0), K(0), K(0)), options);
    u->push = u->support[0].out;
    if (u->only.d.distance2 < u->known2 &&
        join_burier(view, h, u->only.patch, u->support[0].normal, u, 0, options) == BURIED_NO)
      u->state = CONTACT_TOUCHING;
    return;
  }
  u->support[0] = support_of(view, first, make3(K(0), K(0), K(0)), options);
  u->push = u->support[0].out;
  if (join_burier(view, h, base.patch, u->support[0].normal, u, 1, options) == BURIED_YES) {
    // So deep that all of the patch is.
    GLOBAL scalar* numbers = numbers_of(view, base.patch);
    const real size =
        numbers[PATCH_UNSCALE] * norm3(sub3(load3(numbers, PATCH_HIGH), load3(numbers, PATCH_LOW)));
    if (norm3(sub3(u->support[u->count - 1].out, u->push)) > size) return;
  }
  relax(view, h, u, options);
}

// The nearest point of the union, given that of all parts: no point of the union is nearer.
FN_ONCE contact unite_nearest(surface_view view, hip_point h, contact c, track_options options) {
  const real reach = reach_of_hip(h);
  if (is_exposed(view, c.patch) || !(reach <= FAR_OUTSIDE) || (c.flags & FOOT_UNFINISHED)) return c;
  const int was_touching = c.state == CONTACT_TOUCHING;
  union_search u = start_union_at(c);
  int buried = join_burier(view, h, c.patch, c.normal, &u, 0, options);
  if (buried == BURIED_YES && !was_touching)
    buried = is_in_partner(view, h, c.patch, &u.beside, options);
  if (buried != BURIED_YES) return c;
  relax(view, h, &u, options);
  union_search best = u;
  if (u.state == CONTACT_TOUCHING) know_push(&u);
  walk w = start_walk(view);
  for (uint p = next_patch(view, &w, h.high, u.known2); p != NONE && !is_cut(options.spent);
       p = next_patch(view, &w, h.high, u.known2)) {
    if ((view.part[p] & PATCH_BURIED) || !(patch_box_distance2(view, h, p) < u.known2)) continue;
    const base_point b = base_point_on(view, h, p, 0);
    if (!may_hold_nearer(view, b, u.known2)) continue;
    seek_on_patch(view, h, b, &u, options);
    if (u.state == CONTACT_TOUCHING && dot3(u.push, u.push) < u.known2) {
      best = u;
      know_push(&u);
    }
  }
  const real clear = c.clear;
  if (best.state == CONTACT_TOUCHING) {
    c = contact_of_union(view, h, &best, options.spent);
  } else {
    c.state = CONTACT_TOUCHING;
    c.flags &= ~FOOT_CONVERGED;
  }
  if (is_cut(options.spent)) c.clear = clear;
  return c;
}

// Begins anew, with what is left of the budget.
FN_LARGE contact search_union(surface_view view, hip_point h, track_options options) {
  options.spent->is_cut = 0;
  near_patches near;
  const base_point base = nearest_base(view, h, 0u, 1, &near);
  const polygon_blend blend = blend_on_polygon(view, base);
  return nearest_contact(view, h, base, blend, &near, METHOD_GREGORY, options);
}

// The contact that a search along the union has found, or else the nearest point.
FN contact end_union(surface_view view, hip_point h, const union_search* u, track_options options) {
  return u->state == CONTACT_TOUCHING ? contact_of_union(view, h, u, options.spent)
                                      : search_union(view, h, options);
}

// The contact that was on a seam.
FN_LARGE contact follow_seam(surface_view view, hip_point h, contact last, track_options options) {
  union_search u = start_union();
  for (int i = 0; i <= last.held_count; ++i) {
    const domain_point own = {last.patch, last.xi, last.eta};
    const foot f = start_foot(view, h, i == 0 ? own : last.held[i - 1], options.spent);
    u.support[u.count++] = support_of(view, f, make3(K(0), K(0), K(0)), options);
  }
  u.push = u.support[0].out;
  relax(view, h, &u, options);
  return end_union(view, h, &u, options);
}

// From a part that the HIP has left within another: on from above the HIP, where the contact was.
FN_LARGE contact hand_over(surface_view view, hip_point h, contact last, contact c,
                           track_options options) {
  union_search u = start_union_at(c);
  if (is_in_partner(view, h, last.patch, &u.beside, options) != BURIED_YES) return c;
  const domain_point was = {last.patch, last.xi, last.eta};
  const foot f = start_foot(view, h, was, options.spent);
  const union_support left = support_of(view, f, make3(K(0), K(0), K(0)), options);
  const real3 above = mul3(larger(dot3(left.normal, left.out), K(0)), left.normal);
  const hip_point x = moved_hip(h, above);
  GLOBAL uint* table = view.part_table + PART_UINTS * (ulong)part_of(view, last.patch);
  for (uint i = table[PART_PARTNERS]; i < table[PART_PARTNERS_END]; ++i) {
    const uint part = view.partner[i];
    if (!in_part_box(view, h, part)) continue;
    if (is_cut(options.spent)) break;
    const foot on = nearest_on_part(view, x, part, &u.beside, options);
    u.push = above;
    u.support[0] = support_of(view, on, above, options);
    u.count = 1;
    if (!(dot3(u.support[0].normal, u.support[0].out) > K(0))) continue;
    relax(view, h, &u, options);
    if (u.state == CONTACT_TOUCHING) break;
  }
  return end_union(view, h, &u, options);
}

// The contact that followed `last` to c on its own part.
FN_LARGE contact unite_tracked(surface_view view, hip_point h, contact last, contact c,
                               track_options options) {
  const real reach = reach_of_hip(h);
  if (!(reach <= FAR_OUTSIDE)) return c;
  if (last.held_count > 0) return follow_seam(view, h, last, options);
  if (is_exposed(view, c.patch)) return c;
  if (c.state != CONTACT_TOUCHING) return hand_over(view, h, last, c, options);
  union_search u = start_union_at(c);
  if (join_burier(view, h, c.patch, c.normal, &u, 0, options) != BURIED_YES) return c;
  relax(view, h, &u, options);
  return end_union(view, h, &u, options);
}
