// The tiles of a patch (kernels/tile.h): what lets a search leave out parts of it.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/build/patch_draft.h"

namespace gliss {

struct PatchTiles {
  std::vector<std::uint32_t> words;  // [tile][kTileUints]
  double curvature = 0;  // the largest, local frame: that of the tiles is relative to it
};

// Cuts a patch in any form into tiles. `low` and `high`: its oriented box as it is stored. Bounds
// are from samples, a probe's ring apart, widened by what lies between: half as much again as the
// curvature at the samples says.
PatchTiles cut_tiles(const PatchFrame& frame, const PatchShape& shape, const Vec3& low,
                     const Vec3& high, const double* control, std::uint32_t form, std::uint32_t n,
                     const ValenceTables& tables);

}  // namespace gliss
