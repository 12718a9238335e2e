// The tree of boxes over the patches (kernels/hierarchy.h walks it).
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Nodes and children of a binary tree over `boxes` (mesh frame): split at the median of the longest
// axis, so that its depth is at most log2 of their number and a bit. The same boxes give the same
// tree on any number of threads.
template <class Real>
GLISS_EXPORT void build_hierarchy(const std::vector<Box>& boxes, LargeArray<Real>& node,
                                  LargeArray<std::uint32_t>& child, const ParallelFor& parallel);

}  // namespace gliss
