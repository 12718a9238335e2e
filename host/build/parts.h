// Finds the patches that make up each part of a surface, and the parts that overlap others: the
// kernels need both to take overlapping parts as a union of solids (kernels/union.h).
#pragma once

#include <vector>

#include "gliss/base/poll.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Fills `part`, `part_table`, `partner` and `part_box` of a surface whose other arrays are there;
// leaves them empty where no part may lie within a solid one. `boxes`: those that its hierarchy was
// built from.
template <class Real>
void find_parts(const std::vector<Box>& boxes, Surface<Real>& s, const Poll& poll = {});

}  // namespace gliss
