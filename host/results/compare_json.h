// The rows of a comparison as scripts read them. The names of their numbers are a contract.
#pragma once

#include <string>
#include <vector>

#include "gliss/compare/compare_mesh.h"
#include "gliss/compare/recommend.h"
#include "gliss/results/json.h"
#include "gliss/tables/result_file.h"

namespace gliss {

inline constexpr double kMillimetresASecond = 1e6;  // in metres a tick of 1 ms

// All figures of a comparison: depths, stiffness, walks, hands, rows, dense meshes, recommendation.
Json json_of(const MeshComparisonOptions& how, const Comparison& comparison,
             const std::vector<CompareRow>& rows, const std::vector<DenseRow>& dense,
             const Recommendation& best);

// Writes the rows as a table of that name.
void write_rows(ResultFile& file, const std::string& name, const std::vector<CompareRow>& rows);

}  // namespace gliss
