// The base polygon of a patch: its nearest point on a fixed triangulation (faces are not planar),
// and mean value coordinates, which map that point to the domain and interpolate vertex normals
// (4.1; Hormann and Floater 2006).

typedef struct {
  real3 p;          // nearest point, local frame
  real distance2;   // squared, local frame
  int i, j, k;      // corners of its triangle
  real wi, wj, wk;  // barycentric coordinates there
} polygon_point;

// The nearest point of the base polygon of one patch. Where a face is cut into patches round a
// centre, which need not lie on it, a patch has two: its own triangle, and `whole` the piece that
// it holds of the face's polygon (FAN_PIECE).
typedef struct {
  uint patch;
  int whole;
  polygon_point at;
  real distance2;  // squared, mesh frame
} base_point;

// The sides at whose starts a polygon's corners lie: corner k at first + k * stride.
typedef struct {
  uint first, stride;
  int n, triangles;  // corners, triangles of its triangulation
} polygon_sides;

FN GLOBAL uint* triangles_of(surface_view view, uint patch) {
  return view.triangle + 3 * (ulong)(view.side_begin[patch] - 2 * patch);
}
FN int is_of_fan(surface_view view, uint patch) {
  return HAS_FANS(view) && (*triangles_of(view, patch) & FAN_PIECE) != 0u;
}

FN polygon_sides polygon_of(surface_view view, uint patch, int whole) {
  const int n = valence_of(view, patch);
  polygon_sides r = {view.side_begin[patch], 1, n, n - 2};
  if (whole && is_of_fan(view, patch)) {
    GLOBAL uint* piece = triangles_of(view, patch);
    r.first = piece[1];
    r.stride = 3;
    r.n = r.triangles = (int)piece[2];  // a piece each
  }
  return r;
}

typedef struct {
  int i, j, k;
} triangle_corners;

// Triangle t of those of a patch.
FN triangle_corners triangle_of(surface_view view, uint patch, int t, int whole) {
  GLOBAL uint* at = triangles_of(view, patch) + 3 * t;
  triangle_corners r = {(int)at[0], (int)at[1], (int)at[2]};
  if (is_of_fan(view, patch)) {
    const uint piece = at[0];
    r.i = whole ? (int)(piece & FAN_CORNER) : 0;
    r.j = whole ? (int)(piece >> FAN_BITS & FAN_CORNER) : 1;
    r.k = whole ? (int)(piece >> 2 * FAN_BITS & FAN_CORNER) : 2;
  }
  return r;
}

// The patch that holds triangle t of a polygon, and which of its own that is.
FN uint holder_of(surface_view view, polygon_sides s, uint patch, int* t) {
  if (s.stride == 1) return patch;
  const uint holder = view.side_patch[s.first + 3 * (uint)*t];
  *t = 0;
  return holder;
}

// In the frame of `patch`.
FN real3 polygon_corner(surface_view view, uint patch, polygon_sides s, int k) {
  const uint side = s.first + (uint)k * s.stride;
  const real3 own = load3(view.corner + 6 * (ulong)side, 0);
  if (s.stride == 1) return own;
  GLOBAL scalar* from = numbers_of(view, view.side_patch[side]);
  GLOBAL scalar* to = numbers_of(view, patch);
  const real3 apart = sub3(load3(from, PATCH_ORIGIN), load3(to, PATCH_ORIGIN));
  return mul3(to[PATCH_SCALE], fma3(from[PATCH_UNSCALE], own, apart));
}

FN polygon_point nearest_on_triangle(real3 a, real3 b, real3 c, triangle_corners corners, real3 x) {
  const triangle_foot at = foot_on_triangle(a, b, c, x);
  // Exactly 0 opposite to the edge that holds the point, so that place_on_polygon sees it.
  const real u = at.v + at.w == K(1) ? K(0) : K(1) - at.v - at.w;
  const polygon_point r = {at.p, at.distance2, corners.i, corners.j, corners.k, u, at.v, at.w};
  return r;
}

FN_LARGE polygon_point nearest_in_fan(surface_view view, uint patch, real3 x, int whole) {
  const polygon_sides s = polygon_of(view, patch, whole);
  const triangle_corners c = triangle_of(view, patch, 0, whole);
  return nearest_on_triangle(polygon_corner(view, patch, s, c.i),
                             polygon_corner(view, patch, s, c.j),
                             polygon_corner(view, patch, s, c.k), c, x);
}

// Nearest point of the base polygon of a patch to x (local frame).
FN_LARGE polygon_point nearest_on_polygon(surface_view view, uint patch, real3 x, int whole) {
  const int triangles = valence_of(view, patch) - 2;
  GLOBAL scalar* corner = view.corner + 6 * (ulong)view.side_begin[patch];
  GLOBAL uint* at = triangles_of(view, patch);
  if (is_of_fan(view, patch)) return nearest_in_fan(view, patch, x, whole);
  polygon_point best;
  best.distance2 = -K(1);
  for (int t = 0; t < triangles; ++t) {
    const triangle_corners c = {(int)at[3 * t], (int)at[3 * t + 1], (int)at[3 * t + 2]};
    const polygon_point here = nearest_on_triangle(load3(corner, 2 * c.i), load3(corner, 2 * c.j),
                                                   load3(corner, 2 * c.k), c, x);
    if (best.distance2 < K(0) || here.distance2 < best.distance2) best = here;
  }
  return best;
}

// The corners of an edge of a triangle that holds the point, or the corner, or neither (-1).
typedef struct {
  int from, to, corner;
} triangle_place;

FN triangle_place place_on_triangle(polygon_point p) {
  triangle_place r = {-1, -1, -1};
  const int zi = p.wi <= K(0), zj = p.wj <= K(0), zk = p.wk <= K(0);
  if (zi + zj + zk == 2) {
    r.corner = !zi ? p.i : !zj ? p.j : p.k;
  } else if (zi + zj + zk == 1) {
    r.from = zi ? p.j : zj ? p.k : p.i;
    r.to = zi ? p.k : zj ? p.i : p.j;
  }
  return r;
}

// The side of the polygon that holds the point, or the corner, or neither (-1).
typedef struct {
  int side, corner;
} polygon_place;

FN int side_between(int n, int i, int j) {
  return wrap(i + 1, n) == j ? i : wrap(j + 1, n) == i ? j : -1;
}
FN polygon_place place_on_polygon(int n, polygon_point p) {
  const triangle_place at = place_on_triangle(p);
  const polygon_place r = {at.from < 0 ? -1 : side_between(n, at.from, at.to), at.corner};
  return r;
}

// Numbers of the polygon's corners, interpolated by mean value coordinates at a point of it.
typedef struct {
  real xi, eta;  // point of the domain
  real3 normal;  // vertex normals, not of unit length
} polygon_blend;

FN polygon_blend blend_add(polygon_blend sum, surface_view view, polygon_sides s, int k,
                           real weight) {
  GLOBAL scalar* corner = domain_of(view, s.n) + DOMAIN_HEAD + DOMAIN_STRIDE * k + DOMAIN_CORNER;
  sum.xi = fma(weight, corner[0], sum.xi);
  sum.eta = fma(weight, corner[1], sum.eta);
  sum.normal =
      fma3(weight, load3(view.corner + 6 * (ulong)(s.first + (uint)k * s.stride), 1), sum.normal);
  return sum;
}

// Along which a polygon is seen, unit.
FN real3 polygon_axis(surface_view view, uint patch, polygon_sides s) {
  if (s.stride == 1) return load3(numbers_of(view, patch), PATCH_NORMAL);
  real3 sum = zero3();
  for (int k = 0; k < s.n; ++k)
    sum = add3(sum, cross3(polygon_corner(view, patch, s, k),
                           polygon_corner(view, patch, s, wrap(k + 1, s.n))));
  return unit3(sum);
}

// By the domain of the face that a polygon is.
FN_LARGE polygon_blend blend_on_sides(surface_view view, uint patch, polygon_sides s,
                                      polygon_point at) {
  const int n = s.n;
  const polygon_place place = place_on_polygon(n, at);
  const polygon_blend none = {K(0), K(0), {K(0), K(0), K(0)}};
  polygon_blend sum = none;
  if (n > 3 && place.side < 0 && place.corner < 0) {
    // w_k = (tan(alpha_(k-1) / 2) + tan(alpha_k / 2)) / r_k in the plane of the polygon's normal.
    const real3 normal = polygon_axis(view, patch, s);
    real3 s_k = sub3(polygon_corner(view, patch, s, n - 1), at.p);
    s_k = fma3(-dot3(s_k, normal), normal, s_k);
    real r = norm3(s_k), total = K(0), tan_before = K(0);
    for (int k = -1; k < n; ++k) {  // k = -1 makes the tangent before corner 0
      real3 next = sub3(polygon_corner(view, patch, s, wrap(k + 1, n)), at.p);
      next = fma3(-dot3(next, normal), normal, next);
      const real r_next = norm3(next);
      // tan(alpha / 2) by whichever form does not cancel.
      const real across = dot3(normal, cross3(s_k, next)), along = dot3(s_k, next);
      const real tan_half =
          along > K(0) ? across / fma(r, r_next, along) : fma(r, r_next, -along) / across;
      if (k >= 0) {
        const real weight = (tan_before + tan_half) / r;
        total += weight;
        sum = blend_add(sum, view, s, k, weight);
      }
      tan_before = tan_half;
      s_k = next;
      r = r_next;
    }
    const real inverse = K(1) / total;
    sum.xi *= inverse;
    sum.eta *= inverse;
    sum.normal = mul3(inverse, sum.normal);
    // Not where the polygon overlaps itself seen along its normal, nor on a diagonal through a
    // corner's sight.
    if (total > K(0) && fma(sum.xi, sum.xi, sum.eta * sum.eta) <= K(1)) return sum;
    sum = none;
  }
  sum = blend_add(sum, view, s, at.i, at.wi);
  sum = blend_add(sum, view, s, at.j, at.wj);
  return blend_add(sum, view, s, at.k, at.wk);
}

// A point of a face's domain in that of one of its patches round a centre, by the map that takes
// side k of the domain and its middle to the patch's corners. It may lie beyond the patch.
FN polygon_blend in_fan_patch(surface_view view, uint patch, polygon_sides s, polygon_blend b) {
  GLOBAL scalar* corner = domain_of(view, s.n) + DOMAIN_HEAD + DOMAIN_CORNER;
  GLOBAL scalar* own = domain_of(view, 3) + DOMAIN_HEAD + DOMAIN_CORNER;
  const int k = (int)(view.side_begin[patch] - s.first) / 3;
  GLOBAL scalar* from = corner + DOMAIN_STRIDE * k;
  GLOBAL scalar* to = corner + DOMAIN_STRIDE * wrap(k + 1, s.n);
  GLOBAL scalar* middle = own + 2 * DOMAIN_STRIDE;
  const real inverse = K(1) / fma(from[0], to[1], -(from[1] * to[0]));
  const real u = inverse * fma(b.xi, to[1], -(b.eta * to[0])),
             v = inverse * fma(b.eta, from[0], -(b.xi * from[1]));
  b.xi = fma(u, own[0] - middle[0], fma(v, own[DOMAIN_STRIDE] - middle[0], middle[0]));
  b.eta = fma(u, own[1] - middle[1], fma(v, own[DOMAIN_STRIDE + 1] - middle[1], middle[1]));
  return b;
}

FN polygon_blend blend_on_polygon(surface_view view, base_point base) {
  const polygon_sides s = polygon_of(view, base.patch, base.whole);
  const polygon_blend b = blend_on_sides(view, base.patch, s, base.at);
  return s.stride == 1 ? b : in_fan_patch(view, base.patch, s, b);
}
