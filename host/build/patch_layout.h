// Lays out the patches of a cache: which is where, and which sides meet.
#pragma once

#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/build/patch_draft.h"
#include "gliss/mesh/topology.h"

namespace gliss {

// A face's patch, or the patches that it becomes.
struct DraftedFace {
  PatchShape shape;               // of the exact patch
  std::vector<PatchDraft> tamer;  // empty: the exact patch
  bool folded = false, degenerate = false;

  bool flagged() const { return folded || degenerate; }
};

struct PatchLayout {
  LargeArray<std::uint32_t> side_begin{0};  // [patch + 1]
  LargeArray<std::uint32_t> side_twin;      // [side]
};

// Numbers the patches of `faces`, which are `drafted` in the same order, and fills what the cache
// knows of each besides its shape.
PatchLayout lay_out(const Mesh& mesh, const Topology& topology,
                    const std::vector<std::uint32_t>& faces, const LargeArray<DraftedFace>& drafted,
                    PatchCache& cache);

}  // namespace gliss
