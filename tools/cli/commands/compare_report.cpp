#include "tools/cli/commands/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "gliss/results/compare_json.h"
#include "gliss/surface/names.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi, kMicroseconds = 1e6;

std::string held_text(const HeldContacts& leaving) {
  return leaving.contacts == 0 ? "-" : fmt::format("{} of {}", leaving.held, leaving.contacts);
}

std::string rate_text(double per_second) {
  if (!std::isfinite(per_second)) return "-";
  return per_second < 1e6 ? fmt::format("{:.3g} k", per_second * 1e-3)
                          : fmt::format("{:.3g} M", per_second * 1e-6);
}

// In %: less than 1e-12 is rounding.
double percent(double share) {
  const double value = 100 * share;
  return std::abs(value) < 1e-12 ? 0 : value;
}

std::string gain_text(const LoopGain& loops) {
  if (std::isnan(loops.gain)) return "-";
  if (percent(loops.gain) == 0) return "0";
  if (!loops.is_certain()) return fmt::format("< {:.1g}", percent(loops.error));
  return fmt::format("{:.2g}", percent(loops.gain));
}

std::string jumps_text(const FeltWalks& felt) {
  return fmt::format("{:.0f} ± {:.0f}", felt.jumps_per_100k(), felt.jumps_spread_per_100k());
}

}  // namespace

std::string text_of(const Recommendation& best, const CompareBudget& budget) {
  if (best.row == nullptr) return "nothing is recommended: " + best.reason + "\n";
  return fmt::format("recommended{}: {}, {}, {}: {}\n", budget.any() ? " within the budget" : "",
                     best.row->candidate.name(), precision_name(best.row->precision),
                     name_of(kSolverNames, best.row->solver), best.reason);
}

std::string feel_text(const std::vector<CompareRow>& rows) {
  std::string text = fmt::format("  {:<12} {:<6} {:<12}", "surface", "prec.", "solver");
  if (!rows.empty()) {
    for (const CompareWalk& walk : rows.front().walks)
      text += fmt::format(
          " {:>19}",
          fmt::format("{:.3g} mm/s, {:.3g} ms", walk.way * kMillimetresASecond, 1e3 * walk.settle));
  }
  text += fmt::format(" {:>10} {:>10} {:>9} {:>9} {:>9} {:>9}\n", "lost/100k", "held", "loops, %",
                      "p99, %", "error, %", "tick, us");
  for (const CompareRow& row : rows) {
    if (row.backend != rows.front().backend) continue;
    text += fmt::format("{} {:<12} {:<6} {:<12}", row.pareto ? '*' : ' ', row.candidate.name(),
                        precision_name(row.precision), name_of(kSolverNames, row.solver));
    for (const CompareWalk& walk : row.walks) text += fmt::format(" {:>19}", jumps_text(walk.felt));
    text +=
        fmt::format(" {:>10.1f} {:>10} {:>9} {:>9.2g} {:>9.3g} {:>9.2f}\n", row.lost_per_100k,
                    held_text(row.leaving), gain_text(row.loop_gain), percent(row.p99_force_error),
                    percent(row.max_force_error), row.tick * kMicroseconds);
    text += unsound_text(row.unsound, "steps");
  }
  return text;
}

std::string cost_text(const std::vector<CompareRow>& rows) {
  std::string text = fmt::format(
      "  {:<12} {:<6} {:<12} {:<6} {:>8} {:>9} {:>8} {:>8} {:>10} {:>10} {:>9} {:>9} {:>9} {:>9} "
      "{:>9} {:>9} {:>11}\n",
      "surface", "prec.", "solver", "on", "B/patch", "build/s", "eval/s", "track/s", "far, mm",
      "p99, mm", "gap, deg", "p99, deg", "step, N", "p99, N", "walk, N", "p99, N", "beyond/100k");
  for (const CompareRow& row : rows) {
    text += fmt::format(
        "  {:<12} {:<6} {:<12} {:<6} {:>8.0f} {:>9} {:>8} {:>8} {:>10.3g} {:>10.3g} {:>9.2g} "
        "{:>9.2g} {:>9.4g} {:>9.4g} {:>9.4g} {:>9.4g} {:>11.1f}\n",
        row.candidate.name(), precision_name(row.precision), name_of(kSolverNames, row.solver),
        row.backend, row.bytes_per_patch, rate_text(row.build_per_s), rate_text(row.eval_per_s),
        rate_text(row.track_per_s), row.max_distance * 1e3, row.p99_distance * 1e3,
        row.max_normal_gap * kDegrees, row.p99_normal_gap * kDegrees, row.max_force_step,
        row.p99_force_step, row.walk_max_force_step, row.walk_p99_force_step,
        row.steps_beyond_2dx_per_100k);
  }
  return text;
}

std::string text_of(const DenseRow& row) {
  std::string text = fmt::format("{} needs ", method_name(row.method));
  if (row.reached) {
    text += fmt::format("{} triangles", row.triangles);
  } else if (std::isfinite(row.needed_triangles)) {
    text += fmt::format("more than {} triangles, about {:.2g} by extrapolation,", row.triangles,
                        row.needed_triangles);
  } else {
    text += fmt::format("more than {} triangles", row.triangles);
  }
  return text + fmt::format(
                    " to feel as smooth as {} ({:.4g} N; {:.4g} N, jumps {:.1f} and lost {:.1f} "
                    "per 100k with {}: {:.3g} x the memory, {:.3g} x the time)\n",
                    row.target, row.target_step, row.max_force_step, row.jumps_per_100k,
                    row.lost_per_100k, row.triangles, row.memory_ratio, row.time_ratio);
}

std::string text_of(const CompareWalks& walks, const WalkOptions& walk) {
  if (walks.sets.empty()) return "lost/100k: per 100,000 ticks in contact along the path\n";
  return fmt::format(
      "mm/s, ms: jumps of the force in 100,000 ticks in contact, ± one standard deviation over "
      "seeds, by the hand's speed in a loop of 1 kHz and by settle: {} random walks of {} ticks, "
      "{:.3g} mm deep; lost/100k, walk, N, beyond/100k: of the slow ones with settle as given; "
      "loops: net "
      "work, of force x way, that {} closed loops a face wide give the hand at most\n",
      walk.walkers, walk.ticks, walks.depth * 1e3, walks.loops.size());
}

std::string text_of(const LeavingOptions& leaving, double settle) {
  if (leaving.hands == 0) return "";
  return fmt::format(
      "held: contacts of {} hands that press in, slide, leave at up to 2 % of the mesh's diagonal "
      "a tick, and rest outside, that are felt there for longer than {} ticks of 1 ms\n",
      leaving.hands, held_bound(settle));
}

}  // namespace gliss::tools
