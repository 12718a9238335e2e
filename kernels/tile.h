// Tiles: pieces that a patch's domain is cut into, each in a flat cylinder, how far its normals
// turn and how it curves there. A search leaves out those that are too far or turned away, and
// knows from which of the others it has to start.
//
// A patch of n sides has n L^2: the triangle from its centre to each side is cut into L rows, row r
// of 2 r + 1 tiles. Made on the host (host/build/patch_tiles.h).

typedef struct {
  tile_places at;
  uint patch;
  int n, levels;
  real unscale2;
} patch_tiles;

FN patch_tiles tiles_of(surface_view view, hip_point h, uint patch) {
  GLOBAL scalar* numbers = numbers_of(view, patch);
  const real3 normal = load3(numbers, PATCH_NORMAL), tangent = load3(numbers, PATCH_TANGENT);
  const real3 x = local_hip(view, h, patch);
  patch_tiles t;
  const uint first = view.tile_begin[patch];
  const int count = (int)(view.tile_begin[patch + 1] - first);
  t.patch = patch;
  t.n = valence_of(view, patch);
  t.levels = 1;
  while (t.n * t.levels * t.levels < count) ++t.levels;
  const real3 low = load3(numbers, PATCH_LOW), size = sub3(load3(numbers, PATCH_HIGH), low),
              step = mul3(K(1) / K(65535), size);
  const tile_places at = {view.tile + TILE_UINTS * (ulong)first,
                          count,
                          {low.x, low.y, low.z},
                          {step.x, step.y, step.z},
                          K(2) * larger(larger(step.x, step.y), step.z),
                          numbers[PATCH_CURVATURE],
                          {dot3(x, tangent), dot3(x, cross3(normal, tangent)), dot3(x, normal)}};
  t.at = at;
  t.unscale2 = numbers[PATCH_UNSCALE] * numbers[PATCH_UNSCALE];
  return t;
}

// True if the squared distance to the HIP is convex over the tile's points that are nearer than
// `distance` (local): then a minimum is the only one. The curvature towards the HIP decides, with a
// quarter to spare for what lies between samples.
FN int is_convex(patch_tiles t, int i, real height, real distance) {
  const uint word = tile_words(t.at, TILE_HALF_CURVES, i);
  const real most = K(0.75f), above = -curvature_of(t.at, word >> 16) * distance,
             below = curvature_of(t.at, word >> 24) * distance;
  const real steep = distance * K(0.5f);
  return (height < -steep || above <= most) && (height > steep || below <= most);
}

FN sym2 second_of(patch_tiles t, int i) {
  return second_of_code(tile_words(t.at, TILE_SECOND_FORM, i));
}

// The middle of a tile in the domain.
FN domain_vector middle_of(patch_tiles t, GLOBAL scalar* domain, int i) {
  const int of_fan = t.levels * t.levels, k = i / of_fan;
  int row = 0, j = i % of_fan;
  while ((row + 1) * (row + 1) <= j) ++row;
  j -= row * row;
  const int up = j % 2 == 0;
  // In thirds of a row: of its corners' sums.
  const real ring = (real)(3 * row + (up ? 2 : 1)), along = (real)(3 * (j / 2) + (up ? 1 : 2));
  const real height = K(1) / (real)(3 * t.levels);
  const domain_vector a = domain_corner(domain, k), b = domain_corner(domain, wrap(k + 1, t.n));
  const real u = (ring - along) * height, v = along * height;
  return make_vector(fma(u, a.xi, v * b.xi), fma(u, a.eta, v * b.eta));
}

// True if a point lies within the domain, off its sides.
FN int is_inside(GLOBAL scalar* domain, int n, domain_vector x) {
  for (int k = 0; k < n; ++k) {
    if (!(side_distance(domain, n, k, x.xi, x.eta).f > K(0))) return 0;
  }
  return 1;
}

// The tile that a point of the domain lies in.
FN int tile_at(patch_tiles t, GLOBAL scalar* domain, domain_vector x) {
  int fan = 0;
  real u = K(0), v = K(0), inside = K(-2);
  for (int k = 0; k < t.n; ++k) {
    const domain_vector a = domain_corner(domain, k), b = domain_corner(domain, wrap(k + 1, t.n));
    const real over = K(1) / fma(a.xi, b.eta, -(a.eta * b.xi));
    const real p = fma(x.xi, b.eta, -(x.eta * b.xi)) * over,
               q = fma(a.xi, x.eta, -(a.eta * x.xi)) * over;
    const real least = smaller(p, q);
    if (least > inside) {
      inside = least;
      fan = k;
      u = p;
      v = q;
    }
    if (least >= K(0)) break;
  }
  const real levels = (real)t.levels;
  const real along = larger(v, K(0)) * levels, ring = larger(u, K(0)) * levels + along;
  const int row = ring < levels ? (int)ring : t.levels - 1;
  const int i = along < (real)(row + 1) ? (int)along : row;
  const int down = i < row && along - (real)i > ring - (real)row;
  return t.levels * t.levels * fan + row * row + 2 * i + down;
}

// True if the squared distance is convex all the way between two points of the domain, which takes
// a look every half a tile.
FN_LARGE int is_convex_between(patch_tiles t, GLOBAL scalar* domain, domain_vector a,
                               domain_vector b, real distance) {
  const domain_vector way = make_vector(b.xi - a.xi, b.eta - a.eta);
  const real length = sqrt(fma(way.xi, way.xi, way.eta * way.eta));
  const int steps = 1 + (int)(length * (real)(2 * t.levels));
  int last = -1;
  for (int i = 0; i <= steps; ++i) {
    const real share = (real)i / (real)steps;
    const int tile =
        tile_at(t, domain, make_vector(fma(share, way.xi, a.xi), fma(share, way.eta, a.eta)));
    if (tile == last) continue;
    last = tile;
    const real height = dot3(away_from(t.at, tile), axis_of(t.at, tile));
    if (!is_convex(t, tile, height, distance)) return 0;
  }
  return 1;
}
