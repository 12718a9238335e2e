// How near the tiles of a patch (tile.h) may be to a HIP, of as many at a time as there are lanes.

// The words of the patch's tiles, row by row, and numbers that all share, along the axes of its
// box.
typedef struct {
  GLOBAL uint* word;
  int count;
  scalar low[3], step[3];  // of centres
  scalar unit;             // of radii and heights
  scalar curvature;        // that 127 stands for
  scalar hip[3];
} tile_places;

FN uints tile_words(tile_places t, int row, int i) {
  return load_uints(t.word + row * t.count + i);
}

// From the centres of the tiles from i on to the HIP.
FN real3 away_from(tile_places t, int i) {
  const uints xy = tile_words(t, TILE_CENTRE_XY, i);
  const real z = low_half(tile_words(t, TILE_CENTRE_Z_RADIUS, i));
  return make3(splat(t.hip[0]) - centre_of_code(low_half(xy), splat(t.low[0]), splat(t.step[0])),
               splat(t.hip[1]) - centre_of_code(high_half(xy), splat(t.low[1]), splat(t.step[1])),
               splat(t.hip[2]) - centre_of_code(z, splat(t.low[2]), splat(t.step[2])));
}

// False only if the ball round a tile's cylinder is farther than `distance` (local): cheaper than
// reach_of.
FN mask may_reach(tile_places t, int i, scalar distance) {
  const real3 away = away_from(t, i);
  const real size = high_half(tile_words(t, TILE_CENTRE_Z_RADIUS, i)) +
                    low_half(tile_words(t, TILE_HALF_CURVES, i)),
             most = fma(splat(t.unit), size, splat(distance));
  return dot3(away, away) <= most * most;
}

typedef struct {
  real distance2;  // squared, local: no point of the tile is nearer
  real height;     // of the HIP over the tile, local
  mask has_foot;   // false: no normal of the tile leads to the HIP (Johnson and Cohen 2001)
} tile_reach;

FN real3 axis_of(tile_places t, int i) {
  const uints axis = tile_words(t, TILE_AXIS, i);
  return axis_of_codes(reals_of(axis & 4095u), reals_of(axis >> 12 & 4095u));
}

FN real curvature_of(tile_places t, uints bits) {
  return curvature_of_code(reals_of(bits & 255u), splat(t.curvature));
}

// How far aside of a tile's centre a HIP at a height may be at most, that a normal of the tile
// leads to. The normal of a point that is u aside passes the height u (1 + height mean) aside, mean
// being that of the tile's curvatures, and farther by what else it turns.
FN real reach_of_normals(tile_places t, int i, uints curves, real height, real radius,
                         real half_height) {
  const uints bits = tile_words(t, TILE_AXIS, i) >> 24;
  const real root = reals_of(bits & (uint)TILE_ANY_LEAN), lean = tangent_of_code(root);
  const real mean = K(0.5f) * (curvature_of(t, curves) + curvature_of(t, curves >> 8));
  const real spread = fma(half_height, fabs(mean), fabs(fma(height, mean, splat(K(1)))));
  const mask bends = reals_of(bits & (uint)TILE_LEANS_BY_CURVATURE) > splat(K(0));
  const real reach =
      fma(radius, pick(bends, spread, splat(K(1))), lean * (fabs(height) + half_height));
  return pick(root == splat(K(TILE_ANY_LEAN)), splat(K(INFINITY)), reach);
}

FN tile_reach reach_of(tile_places t, int i) {
  const real3 away = away_from(t, i), along = axis_of(t, i);
  const uints half_curves = tile_words(t, TILE_HALF_CURVES, i);
  const real radius = t.unit * high_half(tile_words(t, TILE_CENTRE_Z_RADIUS, i)),
             half_height = t.unit * low_half(half_curves);
  const real zero = splat(K(0));
  tile_reach r;
  r.height = dot3(away, along);
  const real aside = norm3(fma3(-r.height, along, away)), above = fabs(r.height) - half_height;
  const real out = larger(aside - radius, zero), up = larger(above, zero);
  r.distance2 = fma(out, out, up * up);
  r.has_foot = aside <= reach_of_normals(t, i, half_curves >> 16, r.height, radius, half_height);
  return r;
}

// False only if no point of a tile is as near as `distance` (local), or none has its foot there.
FN mask may_hold_foot(tile_places t, int i, scalar distance) {
  const mask near = may_reach(t, i, distance);
#if GLISS_LANES > 1
  if (any(near)) {
    const tile_reach reach = reach_of(t, i);
    return near & (reach.distance2 <= splat(distance * distance)) & reach.has_foot;
  }
#endif
  return near;
}

// Returns which tiles may hold a foot: bit i stands for tile first + i. Lanes past the last tile
// read words of the next row; their bits are masked off.
#define TILES_AT_ONCE 64
FN ulong tiles_in_reach(tile_places t, int first, scalar distance) {
  const int left = t.count - first, count = left < TILES_AT_ONCE ? left : TILES_AT_ONCE;
  ulong found = 0;
  for (int i = 0; i < count; i += GLISS_LANES)
    found |= bits_of(may_hold_foot(t, first + i, distance)) << i;
  return count == TILES_AT_ONCE ? found : found & (((ulong)1 << count) - 1);
}
#ifndef NEAR_TILES
#define NEAR_TILES tiles_in_reach
#endif
