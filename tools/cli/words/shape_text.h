// Says what a surface is like: its creases, and where it is not what a hand expects. Where it
// curves tighter than a HIP is deep, its nearest point leaps; and it may leave its polygons.
#pragma once

#include <string>

#include "gliss/mesh/mesh.h"
#include "gliss/surface/patch_cache.h"
#include "tools/cli/terminal/answer.h"

namespace gliss::tools {

// Prints tight_curvature_text on stderr, with `name` before it where that is not empty; nothing
// with --quiet.
void tell_tight_curvature(const ReportOptions& options, const PatchCache& cache, double depth,
                          const std::string& meaning = "", const std::string& name = "");

// "patches leave their polygons by up to 1.2 mm (0.8 % of the size, 30 % of the 4 mm to the next
// face there: face 12)".
std::string departure_text(const PatchCache& cache);
Json departure_json(const Departure& departure, double unit);
// Warns on stderr where a patch leaves its polygon by more than a third of the room there.
void tell_departure(const ReportOptions& options, const PatchCache& cache);

std::string creases_text(std::size_t count);  // "; 12 edges are creases", or "" where none is
// "; 12 creases are rounded: faces 6 to 29 are their strips", or "" where none is.
std::string rounded_text(const Mesh& mesh);
// "4.67 mm", or "none, as all is flat".
std::string radius_text(double radius, const std::string& unit);
Json radius_json(double radius);

}  // namespace gliss::tools
