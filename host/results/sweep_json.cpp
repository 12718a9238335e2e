#include "gliss/results/sweep_json.h"

#include <fmt/format.h>

#include "gliss/surface/names.h"

namespace gliss {

std::string depth_name(double depth) { return fmt::format("{:.9g}mm", depth * 1e3); }

Json json_of(const SweepStatistics& s) {
  Json json = {{"depth_m", s.depth},
               {"method", method_name(s.method)},
               {"samples", s.samples},
               {"touching", s.touching},
               {"unconverged", s.unconverged},
               {"iterations_sum", s.iterations},
               {"crossings_sum", s.crossings},
               {"jumps_per_100k", s.jumps_per_100k()},
               {"lost_per_100k", s.lost_per_100k()},
               {"leaps_per_100k", s.leaps_per_100k()},
               {"may_be_sparse", s.may_be_sparse()}};
  for (const auto& [name, unit, histogram] : kHistograms) {
    const Histogram& h = s.*histogram;
    json[fmt::format("{}_{}", name, unit)] = {
        {"count", h.count()},     {"mean", h.mean()},        {"p50", h.quantile(0.5)},
        {"p90", h.quantile(0.9)}, {"p99", h.quantile(0.99)}, {"p999", h.quantile(0.999)},
        {"max", h.max()},         {"unsound", h.unsound()}};
  }
  return json;
}

}  // namespace gliss
