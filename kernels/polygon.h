// The base polygon of a patch: its nearest point on a fixed triangulation (faces are not planar),
// and mean value coordinates, which map that point to the domain and interpolate vertex normals
// (4.1; Hormann and Floater 2006).

typedef struct {
  real3 p;          // nearest point, local frame
  real distance2;   // squared, local frame
  int i, j, k;      // corners of its triangle
  real wi, wj, wk;  // barycentric coordinates there
} polygon_point;

FN real3 polygon_corner(surface_view view, uint patch, int k) {
  return load3(view.corner + 6 * (ulong)(view.side_begin[patch] + (uint)k), 0);
}

// Nearest point of the base polygon to x (local frame).
FN_LARGE polygon_point nearest_on_polygon(surface_view view, uint patch, real3 x) {
  const int triangles = valence_of(view, patch) - 2;
  GLOBAL uint* corners = view.triangle + 3 * (ulong)(view.side_begin[patch] - 2 * patch);
  polygon_point best;
  best.distance2 = -K(1);
  for (int t = 0; t < triangles; ++t) {
    const int i = (int)corners[3 * t], j = (int)corners[3 * t + 1], k = (int)corners[3 * t + 2];
    const real3 a = polygon_corner(view, patch, i), b = polygon_corner(view, patch, j),
                c = polygon_corner(view, patch, k);
    const triangle_foot at = foot_on_triangle(a, b, c, x);
    if (best.distance2 < K(0) || at.distance2 < best.distance2) {
      // Exactly 0 opposite to the edge that holds the point, so that place_on_polygon sees it.
      const real u = at.v + at.w == K(1) ? K(0) : K(1) - at.v - at.w;
      const polygon_point here = {at.p, at.distance2, i, j, k, u, at.v, at.w};
      best = here;
    }
  }
  return best;
}

// The side of the polygon that holds the point, or the corner, or neither (-1).
typedef struct {
  int side, corner;
} polygon_place;

FN int side_between(int n, int i, int j) {
  return wrap(i + 1, n) == j ? i : wrap(j + 1, n) == i ? j : -1;
}
FN polygon_place place_on_polygon(int n, polygon_point p) {
  polygon_place r = {-1, -1};
  const int zi = p.wi <= K(0), zj = p.wj <= K(0), zk = p.wk <= K(0);
  if (zi + zj + zk == 2) {
    r.corner = !zi ? p.i : !zj ? p.j : p.k;
  } else if (zi + zj + zk == 1) {
    r.side = zi   ? side_between(n, p.j, p.k)
             : zj ? side_between(n, p.k, p.i)
                  : side_between(n, p.i, p.j);
  }
  return r;
}

// Numbers of the polygon's corners, interpolated by mean value coordinates at a point of it.
typedef struct {
  real xi, eta;  // point of the domain
  real3 normal;  // vertex normals, not of unit length
} polygon_blend;

FN polygon_blend blend_add(polygon_blend sum, surface_view view, uint patch, int k, real weight) {
  const int n = valence_of(view, patch);
  GLOBAL scalar* corner = domain_of(view, n) + DOMAIN_HEAD + DOMAIN_STRIDE * k + DOMAIN_CORNER;
  sum.xi = fma(weight, corner[0], sum.xi);
  sum.eta = fma(weight, corner[1], sum.eta);
  sum.normal = fma3(weight, load3(view.corner + 6 * (ulong)(view.side_begin[patch] + (uint)k), 1),
                    sum.normal);
  return sum;
}

FN_LARGE polygon_blend blend_on_polygon(surface_view view, uint patch, polygon_point at) {
  const int n = valence_of(view, patch);
  const polygon_place place = place_on_polygon(n, at);
  const polygon_blend none = {K(0), K(0), {K(0), K(0), K(0)}};
  polygon_blend sum = none;
  if (n > 3 && place.side < 0 && place.corner < 0) {
    // w_k = (tan(alpha_(k-1) / 2) + tan(alpha_k / 2)) / r_k in the plane of the polygon's normal.
    const real3 normal = load3(numbers_of(view, patch), PATCH_NORMAL);
    real3 s = sub3(polygon_corner(view, patch, n - 1), at.p);
    s = fma3(-dot3(s, normal), normal, s);
    real r = norm3(s), total = K(0), tan_before = K(0);
    for (int k = -1; k < n; ++k) {  // k = -1 makes the tangent before corner 0
      real3 next = sub3(polygon_corner(view, patch, wrap(k + 1, n)), at.p);
      next = fma3(-dot3(next, normal), normal, next);
      const real r_next = norm3(next);
      // tan(alpha / 2) by whichever form does not cancel.
      const real across = dot3(normal, cross3(s, next)), along = dot3(s, next);
      const real tan_half =
          along > K(0) ? across / fma(r, r_next, along) : fma(r, r_next, -along) / across;
      if (k >= 0) {
        const real weight = (tan_before + tan_half) / r;
        total += weight;
        sum = blend_add(sum, view, patch, k, weight);
      }
      tan_before = tan_half;
      s = next;
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
  sum = blend_add(sum, view, patch, at.i, at.wi);
  sum = blend_add(sum, view, patch, at.j, at.wj);
  return blend_add(sum, view, patch, at.k, at.wk);
}
