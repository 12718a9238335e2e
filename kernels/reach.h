// Balls round the tiles of a patch (tile.h), of as many at a time as there are lanes.

// The words of the patch's tiles, row by row, and numbers that all share, along the axes of its
// box.
typedef struct {
  GLOBAL uint* word;
  int count;
  scalar low[3], step[3];  // of centres
  scalar unit;             // of radii and heights
  scalar hip[3];
} tile_balls;

FN real low_half(uints word) { return reals_of(word & 65535u); }
FN real high_half(uints word) { return reals_of(word >> 16); }

FN uints tile_words(tile_balls b, int row, int i) { return load_uints(b.word + row * b.count + i); }

// From the centres of the tiles from i on to the HIP.
FN real3 away_from(tile_balls b, int i) {
  const uints xy = tile_words(b, TILE_CENTRE_XY, i);
  const real z = low_half(tile_words(b, TILE_CENTRE_Z_RADIUS, i));
  return make3(splat(b.hip[0]) - fma(low_half(xy), splat(b.step[0]), splat(b.low[0])),
               splat(b.hip[1]) - fma(high_half(xy), splat(b.step[1]), splat(b.low[1])),
               splat(b.hip[2]) - fma(z, splat(b.step[2]), splat(b.low[2])));
}

// False only if the ball round a tile's cylinder is farther than `distance` (local): cheaper than
// reach_of.
FN mask may_reach(tile_balls b, int i, scalar distance) {
  const real3 away = away_from(b, i);
  const real size = high_half(tile_words(b, TILE_CENTRE_Z_RADIUS, i)) +
                    low_half(tile_words(b, TILE_HALF_CURVES, i)),
             most = fma(splat(b.unit), size, splat(distance));
  return dot3(away, away) <= most * most;
}

// Bit i stands for tile first + i. Words of other rows, or none if there are too few, follow those
// of the last tiles.
#define TILES_AT_ONCE 64
FN ulong tiles_in_reach(tile_balls b, int first, scalar distance) {
  const int left = b.count - first, count = left < TILES_AT_ONCE ? left : TILES_AT_ONCE;
  ulong found = 0;
  for (int i = 0; i < count; i += GLISS_LANES)
    found |= bits_of(may_reach(b, first + i, distance)) << i;
  return count == TILES_AT_ONCE ? found : found & (((ulong)1 << count) - 1);
}
#ifndef NEAR_TILES
#define NEAR_TILES tiles_in_reach
#endif
