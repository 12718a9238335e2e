// Lays out the patches of a cache: which is where, and which sides meet.
#pragma once

#include <span>
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

// Numbers the patches of `faces`, which are `drafted` in the same order, after those before, and
// adds what else the cache knows of each.
void number_patches(const Mesh& mesh, std::span<const std::uint32_t> faces,
                    std::span<const DraftedFace> drafted, PatchCache& cache, PatchLayout& layout);

// Finds the twins of all sides, once all patches of `faces` have their numbers.
void join_sides(const Mesh& mesh, const Topology& topology, std::span<const std::uint32_t> faces,
                const PatchCache& cache, PatchLayout& layout);

}  // namespace gliss
