// The rows of a comparison as people and scripts read them. The names of their numbers are a
// contract.
#pragma once

#include <string>
#include <vector>

#include "gliss/study/compare.h"
#include "gliss/study/recommend.h"
#include "gliss/tables/result_file.h"
#include "tools/cli/command.h"

namespace gliss::tools {

Json json_of(const CompareRow& row);
Json recommendation_json(const CompareRow& row);
std::string text_of(const Recommendation& best, const CompareBudget& budget);
Json json_of(const DenseRow& row, const CompareRow& target);
// Null where there are no walks.
Json json_of(const CompareWalks& walks, const WalkOptions& walk);

// Null where there are no hands.
Json json_of(const LeavingOptions& leaving);

// A table of what a hand feels, which no backend changes, and one of costs and shape.
std::string feel_text(const std::vector<CompareRow>& rows);
std::string cost_text(const std::vector<CompareRow>& rows);
std::string text_of(const DenseRow& row);
std::string text_of(const CompareWalks& walks, const WalkOptions& walk);
// `settle`: as in CompareOptions. "" where there are no hands.
std::string text_of(const LeavingOptions& leaving, double settle);

// Writes the rows as a table of that name.
void write_rows(ResultFile& file, const std::string& name, const std::vector<CompareRow>& rows);

}  // namespace gliss::tools
