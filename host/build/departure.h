// How far the patches of a cache leave their polygons. Private to host/.
#pragma once

#include <span>

#include "gliss/base/parallel.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Fills `departure` and `tightest` of a cache whose other arrays are there. `sag` [patch]: the
// largest distance of a sample of it from its base polygon, mesh frame.
void find_departures(PatchCache& cache, std::span<const double> sag, const ParallelFor& parallel);

}  // namespace gliss
