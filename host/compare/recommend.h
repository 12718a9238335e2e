// Which surface to take: that by which a hand feels least that is wrong.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/compare/compare.h"

namespace gliss {

// The most that a recommended row may cost.
struct CompareBudget {
  std::optional<double> force_error, tick, memory;  // ratio, s, bytes

  bool any() const { return force_error || tick || memory; }
};

struct Recommendation {
  const CompareRow* row = nullptr;  // null: none
  std::string reason{};             // a sentence
};

// Chooses among the rows within the budget. Out are baselines that jump more than the patches that
// jump least, within the budget or not, and baselines whose closed loops give the hand energy, or
// that are shaded where no loop tells. Patches that give energy are out if any other row is left.
// Rows stay that have the fewest jumps over all walks, then those with the fewest contacts held
// outside, each but for the spread. The least p99 of the error of force decides between them, or
// the quickest tick where the budget says what error is allowed; then the fewest bytes. The rows
// must outlive the result.
GLISS_EXPORT Recommendation recommend(const std::vector<CompareRow>& rows,
                                      const CompareBudget& budget);

// Marks rows that no other beats in jumps, p99 of the error, tick and memory at once.
GLISS_EXPORT void mark_pareto(std::vector<CompareRow>& rows);

}  // namespace gliss
