// How far the patches of a cache leave their polygons. Private to host/.
#pragma once

#include "gliss/base/parallel.h"
#include "gliss/build/patch_batch.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Fills `departure` and `tightest` of a cache whose other arrays are there. The bounds of samples
// (PatchShape::sag) say which faces to look at, and a grid on their patches what is said of them.
// `tables` has the valences of all patches.
void find_departures(PatchCache& cache, const ValenceTables& tables, const ParallelFor& parallel);

}  // namespace gliss
