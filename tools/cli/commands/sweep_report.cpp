#include "tools/cli/commands/sweep_report.h"

#include <fmt/format.h>

#include <optional>

#include "gliss/results/sweep_json.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

namespace {

// Counts the jumps of each method, a line a depth: a hand feels these of a sweep.
std::string jumps_text(const SweepResult& result) {
  std::string text;
  std::optional<double> depth;
  for (const SweepStatistics& s : result.statistics) {
    if (depth) text += *depth == s.depth ? ", " : "\n";
    if (depth != s.depth)
      text += fmt::format(
          "at {} the force jumps between so many of 100,000 pairs of neighbours among {} "
          "samples: ",
          depth_name(s.depth), s.samples);
    text += fmt::format("{} {:.0f}", method_name(s.method), s.jumps_per_100k());
    depth = s.depth;
  }
  return text + "\n";
}

// Names the depths at which a smooth force may change by 20 % from one sample to the next.
std::string sparse_text(const SweepResult& result) {
  std::string text;
  for (const SweepStatistics& s : result.statistics) {
    if (s.method != Method::kGregory || !s.may_be_sparse()) continue;
    text += fmt::format(
        "at {} the samples may be too far apart to count jumps: if those of gregory become fewer "
        "with --samples {}, they are\n",
        depth_name(s.depth), 4 * s.samples);
  }
  return text;
}

}  // namespace

std::string text_of(const SweepResult& result) {
  std::string text =
      fmt::format("{:<8} {:<8} {:>23} {:>29} {:>29} {:>19} {:>19} {:>6} {:>8}\n", "", "",
                  "per 100k pairs", "step across edges, N", "step within patches, N", "angle, rad",
                  "error, N", "iter.", "not con-") +
      fmt::format(
          "{:<8} {:<8} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} "
          "{:>9} {:>6} {:>8}\n",
          "depth", "method", "jumps", "lost", "leaps", "mean", "p99", "max", "mean", "p99", "max",
          "p99", "max", "p99", "max", "mean", "verged");
  for (const SweepStatistics& s : result.statistics) {
    text += fmt::format("{:<8} {:<8} {:>7.1f} {:>7.1f} {:>7.1f}", depth_name(s.depth),
                        method_name(s.method), s.jumps_per_100k(), s.lost_per_100k(),
                        s.leaps_per_100k());
    for (const Histogram* h : {&s.edge_step, &s.step}) {
      text += fmt::format(" {:>9.3g} {:>9.3g} {:>9.3g}", h->mean(), h->quantile(0.99), h->max());
    }
    for (const Histogram* h : {&s.angle, &s.error}) {
      text += fmt::format(" {:>9.3g} {:>9.3g}", h->quantile(0.99), h->max());
    }
    text += fmt::format(" {:>6.2f} {:>8}\n",
                        static_cast<double>(s.iterations) / static_cast<double>(s.samples),
                        s.unconverged);
    text += unsound_text(s.step.unsound() + s.edge_step.unsound(), "steps");
    text += unsound_text(s.error.unsound(), "errors");
  }
  return text + jumps_text(result) + sparse_text(result);
}

}  // namespace gliss::tools
