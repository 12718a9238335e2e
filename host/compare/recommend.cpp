#include "gliss/compare/recommend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>

namespace gliss {
namespace {

constexpr double kGain = 1e-3;  // of the effort of a loop: less is none
using Rows = std::vector<const CompareRow*>;

struct Count {
  double value = 0, spread = 0;  // one standard deviation
};

bool is_baseline(const CompareRow& row) { return row.candidate.method != Method::kGregory; }

// A force that is shaded has no potential: where no loop stayed in contact it is not known to.
bool makes_energy(const CompareRow& row) {
  const bool is_unknown = std::isnan(row.loop_gain.gain);
  return is_unknown ? row.candidate.method == Method::kShaded : row.loop_gain.excess() > kGain;
}

// Per 100,000 ticks of all walks; along the path where there are none.
Count jumps_of(const CompareRow& row) {
  if (row.walks.empty()) return {row.jumps_per_100k, 0};
  Count mean;
  for (const CompareWalk& walk : row.walks) {
    mean.value += walk.felt.jumps_per_100k();
    mean.spread = std::hypot(mean.spread, walk.felt.jumps_spread_per_100k());
  }
  const auto count = static_cast<double>(row.walks.size());
  return {mean.value / count, mean.spread / count};
}

Count held_of(const CompareRow& row) {
  const auto held = static_cast<double>(row.leaving.held);
  return {held, std::sqrt(std::max(held, 1.0))};
}

const CompareRow* fewest(const Rows& rows, Count count_of(const CompareRow&)) {
  const auto least =
      std::min_element(rows.begin(), rows.end(), [&](const CompareRow* a, const CompareRow* b) {
        return count_of(*a).value < count_of(*b).value;
      });
  return least == rows.end() ? nullptr : *least;
}

// Leaves those that have no more than the fewest, but for the spread.
void keep_fewest(Rows& rows, Count count_of(const CompareRow&)) {
  if (rows.empty()) return;
  const Count least = count_of(*fewest(rows, count_of));
  std::erase_if(rows, [&](const CompareRow* row) {
    const Count count = count_of(*row);
    return count.value - least.value > std::hypot(count.spread, least.spread);
  });
}

bool is_within(const CompareRow& row, const CompareBudget& budget) {
  const auto within = [](double value, const std::optional<double>& most) {
    return !most || value <= *most;
  };
  return within(row.max_force_error, budget.force_error) && within(row.tick, budget.tick) &&
         within(row.bytes, budget.memory);
}

// The jumps of a row, with the walks in which there are most.
std::string jumps_text(const CompareRow& row) {
  const Count jumps = jumps_of(row);
  std::string text = fmt::format("the force jumps {:.0f} ± {:.0f} times in 100,000 ticks",
                                 jumps.value, jumps.spread);
  if (row.walks.size() < 2) return text;
  const CompareWalk& most = *std::max_element(
      row.walks.begin(), row.walks.end(), [](const CompareWalk& a, const CompareWalk& b) {
        return a.felt.jumps_per_100k() < b.felt.jumps_per_100k();
      });
  return text +
         fmt::format(" of all walks (at most {:.0f}, at {:.3g} mm/s and a settle of {:.3g} ms)",
                     most.felt.jumps_per_100k(), most.way * 1e6, 1e3 * most.settle);
}

std::string energy_text(const CompareRow& row) {
  return fmt::format("closed loops give the hand up to {:.2g} % of force x way",
                     100 * row.loop_gain.gain);
}

// Says in one sentence why a row is recommended, and in others what stands against it. `equals`:
// the rows that are as good but for the error, itself among them.
std::string reason_for(const CompareRow& row, const std::vector<CompareRow>& rows,
                       const Rows& patches, std::size_t equals, const CompareBudget& budget) {
  const Count jumps = jumps_of(row);
  const CompareRow* least = fewest(patches, jumps_of);
  const bool is_least =
      least == nullptr || is_baseline(row) || jumps.value - jumps_of(*least).value <= jumps.spread;
  std::string text = jumps_text(row) + (is_least ? ", no more than with any patches"
                                                 : ", as seldom as the budget allows");
  if (makes_energy(row))
    text += ", and " + energy_text(row) + ", as with all patches here";
  else if (!std::isnan(row.loop_gain.gain))
    text += ", and closed loops give the hand no energy";
  text += ".";
  if (row.leaving.contacts > 0)
    text += fmt::format(" {} of {} contacts are held after the hand has left.", row.leaving.held,
                        row.leaving.contacts);
  if (equals > 1)
    text += budget.force_error
                ? fmt::format(" Of the {} that are as good it is the quickest.", equals)
                : fmt::format(
                      " Of the {} that are as good its force is nearest to the exact "
                      "surface's.",
                      equals);
  if (is_baseline(row) || (equals > 1 && !budget.force_error))
    text += fmt::format(" Its force is off by {:.2g} % at most in 99 of 100 ticks of a path.",
                        100 * row.p99_force_error);
  for (const CompareRow& other : rows) {
    if (!is_baseline(other) || !makes_energy(other) || jumps_of(other).value >= jumps.value)
      continue;
    text += fmt::format(
        " {} jumps {:.0f} times, but {}.", other.candidate.name(), jumps_of(other).value,
        std::isnan(other.loop_gain.gain) ? "no loop tells if it gives the hand energy"
                                         : energy_text(other));
    break;
  }
  return text;
}

}  // namespace

Recommendation recommend(const std::vector<CompareRow>& rows, const CompareBudget& budget) {
  Rows patches, left;
  for (const CompareRow& row : rows) {
    if (!is_baseline(row)) patches.push_back(&row);
    if (is_within(row, budget)) left.push_back(&row);
  }
  if (left.empty()) return {nullptr, "nothing is within the budget"};
  const CompareRow* smoothest = fewest(patches, jumps_of);
  std::erase_if(left, [&](const CompareRow* row) {
    if (!is_baseline(*row)) return false;
    return makes_energy(*row) ||
           (smoothest != nullptr && jumps_of(*row).value > jumps_of(*smoothest).value);
  });
  if (left.empty())
    return {nullptr, "all within the budget give the hand energy or jump more than patches do"};
  if (!std::all_of(left.begin(), left.end(),
                   [](const CompareRow* row) { return makes_energy(*row); }))
    std::erase_if(left, [](const CompareRow* row) { return makes_energy(*row); });
  keep_fewest(left, jumps_of);
  keep_fewest(left, held_of);
  const auto cost = [&](const CompareRow* row) {
    return std::tuple(budget.force_error ? row->tick : row->p99_force_error, row->bytes);
  };
  const CompareRow* best = *std::min_element(
      left.begin(), left.end(),
      [&](const CompareRow* a, const CompareRow* b) { return cost(a) < cost(b); });
  return {best, reason_for(*best, rows, patches, left.size(), budget)};
}

void mark_pareto(std::vector<CompareRow>& rows) {
  const auto figures = [](const CompareRow& row) {
    return std::array{jumps_of(row).value, row.p99_force_error, row.tick, row.bytes_per_patch};
  };
  for (CompareRow& row : rows) {
    row.pareto = std::none_of(rows.begin(), rows.end(), [&](const CompareRow& other) {
      const auto a = figures(other), b = figures(row);
      return a != b && std::equal(a.begin(), a.end(), b.begin(), std::less_equal<>());
    });
  }
}

}  // namespace gliss
