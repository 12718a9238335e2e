// The parts of a surface: its patches that edges join. Private to host/.
#pragma once

#include "gliss/mesh/mesh_edges.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/surface.h"

namespace gliss {

template <class Real>
DisjointSets parts_of(const Surface<Real>& s) {
  DisjointSets parts(s.patch_count());
  for (std::size_t side = 0; side < s.side_twin.size(); ++side) {
    if (s.side_twin[side] != kNone)
      parts.unite(s.side_patch[side], s.side_patch[s.side_twin[side]]);
  }
  return parts;
}

}  // namespace gliss
