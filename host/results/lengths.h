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

// The depth of a HIP that is meant where none is given: 0.5 % of the bounding box's diagonal, m.
double usual_depth(const PatchCache& cache);

// "48 % of the faces have a radius of curvature below 0.5 mm: expect jumps there", or "" where no
// face has. A face counts where one of its patches has a least radius of curvature below `depth`
// (m). `meaning`, such as "the depth", follows the length in brackets; it may be empty.
std::string tight_curvature_text(const PatchCache& cache, double depth,
                                 const std::string& meaning = "");

}  // namespace gliss
