// The ways to cut the patches of one valence into tiles, and where each tile's samples lie.
#pragma once

#include <cstdint>
#include <vector>

namespace gliss {

// TileSamples holds where tiles take their samples from: a point's place in an array of samples,
// [point][padded].
struct TileSamples {
  // The probes in each tile, `probe_points` of them, show whether its normals agree. 0: probes are
  // sparser than tiles, which happens only on patches whose normals all agree.
  std::uint32_t probe_points = 0;
  std::vector<std::uint32_t> probe;
  // The points that are sampled, xi of all and eta of all; empty: the probes.
  std::uint32_t count = 0;
  std::vector<double> at;
  std::uint32_t rings = 0;  // of samples in a tile, kCutRings or kCutFewRings
  std::vector<std::uint32_t> sample;
};

// Each fan of a patch, from its centre to a side, in `levels` rows of tiles (kernels/tile.h). Tiles
// are padded to a multiple of kCutPad by the first one, samples by the centre.
struct TileCut {
  std::uint32_t levels = 0, tiles = 0, padded = 0;
  // `gentle` is for gentle patches, whose probes are the coarse ones, `all` for others. One without
  // samples is not for its kind.
  TileSamples all, gentle;
  std::vector<double> transform;  // [kCutTransforms][padded]
};

// Rounds a count of samples or of tiles up to a multiple of kCutPad.
std::uint32_t padded(std::uint32_t count);

// The size of the samples' domain, off the sides.
inline constexpr double kShrink = 1 - 0x1p-16;

// From the fewest tiles to the most.
std::vector<TileCut> tile_cuts_of(std::uint32_t n);

}  // namespace gliss
