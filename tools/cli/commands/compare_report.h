// The rows of a comparison as people read them.
#pragma once

#include <string>
#include <vector>

#include "gliss/compare/compare_mesh.h"
#include "gliss/compare/recommend.h"

namespace gliss::tools {

std::string text_of(const Recommendation& best, const CompareBudget& budget);
// A table of what a hand feels, which no backend changes, and one of costs and shape.
std::string feel_text(const std::vector<CompareRow>& rows);
std::string cost_text(const std::vector<CompareRow>& rows);
std::string text_of(const DenseRow& row);
std::string text_of(const CompareWalks& walks, const WalkOptions& walk);
// `settle`: as in CompareOptions. "" where there are no hands.
std::string text_of(const LeavingOptions& leaving, double settle);

}  // namespace gliss::tools
