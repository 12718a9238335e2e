// The statistics of a sweep as scripts read them.
#pragma once

#include <string>

#include "gliss/results/json.h"
#include "gliss/sweep/sweep.h"

namespace gliss {

// The distributions of a depth and method, by the names that files and tables give them.
struct NamedHistogram {
  const char *name, *unit;
  Histogram SweepStatistics::*histogram;
};
inline constexpr NamedHistogram kHistograms[] = {{"step", "N", &SweepStatistics::step},
                                                 {"edge_step", "N", &SweepStatistics::edge_step},
                                                 {"angle", "rad", &SweepStatistics::angle},
                                                 {"error", "N", &SweepStatistics::error},
                                                 {"residual", "rad", &SweepStatistics::residual}};

std::string depth_name(double depth);  // "2mm"

Json json_of(const SweepStatistics& statistics);

}  // namespace gliss
