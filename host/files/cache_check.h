// The invariants of a patch cache that came from outside.
#pragma once

#include <string>

#include "gliss/surface/patch_cache.h"

namespace gliss {

// Sizes that agree, indices in range and consistent, numbers that a build may make, a hierarchy
// that the walker can walk and whose boxes hold the base polygons: after this no query reads
// outside an array or runs for ever, and what it finds is finite or says that it is not. Throws
// CacheError that names the source, the section and the entry.
void check_cache(const PatchCache& cache, const std::string& source);

}  // namespace gliss
