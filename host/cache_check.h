// The invariants of a patch cache that came from outside.
#pragma once

#include <string>

#include "host/patch_cache.h"

namespace gliss {

// Sizes that agree, indices in range and consistent, numbers finite, a hierarchy that the walker
// can walk: after this no query reads outside an array or runs for ever. Throws CacheError that
// names the source and the section.
void check_cache(const PatchCache& cache, const std::string& source);

}  // namespace gliss
