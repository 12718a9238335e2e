// The arrays that the kernels read, in one precision.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/large_array.h"

namespace gliss {

// The side of a patch that starts where another side of it ends. `side_begin`: [patch + 1].
inline std::uint32_t next_side(const LargeArray<std::uint32_t>& side_begin, std::uint32_t patch,
                               std::uint32_t side) {
  return side + 1 < side_begin[patch + 1] ? side + 1 : side_begin[patch];
}

template <class Real>
struct Surface {
  std::vector<Real> domain;  // tables of the valences in use
  // [valence], where its table begins. No polygon has 0 sides: [0] says what the surface has,
  // such as creases, as bits that caches keep there.
  std::vector<std::uint32_t> domain_begin;
  LargeArray<std::uint32_t> side_begin;     // [patch + 1]
  LargeArray<std::uint32_t> side_patch;     // [side]
  LargeArray<std::uint32_t> side_twin;      // [side], kNone: border
  LargeArray<Real> control;                 // of all patches, by their forms
  LargeArray<std::uint32_t> control_begin;  // [patch], where its own begins, in triples
  LargeArray<std::uint32_t> form;           // [patch], kForm...; of a table with r << 8
  LargeArray<Real> corner;                  // [side][2][3]
  LargeArray<Real> patch;                   // [patch][patch_reals]
  LargeArray<std::uint32_t> triangle;       // [side_begin[p] - 2 p][3], or kFanPiece
  LargeArray<Real> node;                    // [node][2][6]
  LargeArray<std::uint32_t> child;          // [node][2]
  LargeArray<std::uint32_t> tile;           // [kTileUints][tile], patch by patch
  LargeArray<std::uint32_t> tile_begin;     // [patch + 1], tiles before its own
  // Parts that overlap (docs/meshes.md); all empty if no part meets another.
  LargeArray<std::uint32_t> part;         // [patch], its part and kPatch...
  std::vector<std::uint32_t> part_table;  // [part][kPartUints]
  std::vector<std::uint32_t> partner;     // solid parts that may hold a part's points
  std::vector<Real> part_box;             // [part][6], mesh frame

  std::uint32_t patch_count() const {
    return side_begin.empty() ? 0 : static_cast<std::uint32_t>(side_begin.size()) - 1;
  }
  std::uint32_t valence(std::uint32_t patch) const {
    return side_begin[patch + 1] - side_begin[patch];
  }
};

// The same of a surface, which knows the patch.
template <class Real>
std::uint32_t next_side(const Surface<Real>& s, std::uint32_t side) {
  return next_side(s.side_begin, s.side_patch[side], side);
}

}  // namespace gliss
