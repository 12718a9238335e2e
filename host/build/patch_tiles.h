// The tiles of a patch (kernels/tile.h): what lets a search leave out parts of it.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/parallel.h"
#include "gliss/build/patch_draft.h"
#include "gliss/surface/surface.h"

namespace gliss {

struct PatchTiles {
  std::vector<std::uint32_t> words;  // [kTileUints][tile]
  double curvature = 0;  // the largest, local frame: that of the tiles is relative to it
};

// Cuts a patch in any form into tiles. `box`: its oriented box as it is stored. Bounds are from
// samples, four to a tile's side at least, widened by what lies between: half as much again as the
// curvature at the samples says. The normal's is for a patch whose neighbours meet it smoothly.
// `samples`: those that its examination left, or null.
PatchTiles cut_tiles(const PatchFrame& frame, const PatchShape& shape, const Box& box,
                     const ControlData& control, const ValenceTables& tables,
                     const PatchSamples* samples);

// Takes the bound on normals from the tiles along borders and along edges whose two patches differ
// in their normals: a nearest point may lie there that is no foot.
template <class Real>
void free_sharp_sides(Surface<Real>& s, const ValenceTables& tables, const ParallelFor& parallel);

}  // namespace gliss
