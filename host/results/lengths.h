// Lengths and depths as people read and write them.
#pragma once

#include <span>
#include <string>

#include "gliss/surface/patch_cache.h"

namespace gliss {

std::string unit_name(double unit);      // "mm"; "0.5 m" where it has no name
std::string length_text(double metres);  // "1.23 mm"
double diagonal_of(const Box& box);

// Throws std::invalid_argument where a depth (m) is more than the surface is across. `option`
// starts its text.
void check_depths(const std::string& option, std::span<const double> depths,
                  const PatchCache& cache);

}  // namespace gliss
