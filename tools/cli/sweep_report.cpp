#include "tools/cli/sweep_report.h"

#include <fmt/format.h>

#include "tools/cli/command.h"
#include "tools/cli/sweep_statistics.h"

namespace gliss::tools {

std::string text_of(const SweepResult& result) {
  std::string text =
      fmt::format("{:<8} {:<8} {:>29} {:>29} {:>23} {:>19} {:>19} {:>6} {:>8}\n", "", "",
                  "step within patches, N", "step across edges, N", "per 100k pairs", "angle, rad",
                  "error, N", "iter.", "not con-") +
      fmt::format(
          "{:<8} {:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} "
          "{:>9} {:>6} {:>8}\n",
          "depth", "method", "mean", "p99", "max", "mean", "p99", "max", "jumps", "lost", "leaps",
          "p99", "max", "p99", "max", "mean", "verged");
  for (const SweepStatistics& s : result.statistics) {
    text += fmt::format("{:<8} {:<8}", depth_name(s.depth), method_name(s.method));
    for (const Histogram* h : {&s.step, &s.edge_step}) {
      text += fmt::format(" {:>9.3g} {:>9.3g} {:>9.3g}", h->mean(), h->quantile(0.99), h->max());
    }
    text += fmt::format(" {:>7.1f} {:>7.1f} {:>7.1f}", s.jumps_per_100k(), s.lost_per_100k(),
                        s.leaps_per_100k());
    for (const Histogram* h : {&s.angle, &s.error}) {
      text += fmt::format(" {:>9.3g} {:>9.3g}", h->quantile(0.99), h->max());
    }
    text += fmt::format(" {:>6.2f} {:>8}\n",
                        static_cast<double>(s.iterations) / static_cast<double>(s.samples),
                        s.unconverged);
    text += unsound_text(s.step.unsound() + s.edge_step.unsound(), "steps");
    text += unsound_text(s.error.unsound(), "errors");
  }
  return text;
}

}  // namespace gliss::tools
