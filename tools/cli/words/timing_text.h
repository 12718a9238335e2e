// Distributions of durations as commands print them.
#pragma once

#include <string>

#include "gliss/results/json.h"
#include "gliss/thread/timing.h"

namespace gliss::tools {

double microseconds(Nanoseconds time);

Json json_of(const DurationHistogram& durations);  // p50_us, p99_us, p999_us, max_us
// {"wake": [[longest_us, count], ...], "compute": ...}
Json histograms_json(const TickRecord& record);

std::string timing_header();
std::string timing_row(const char* name, const DurationHistogram& durations);

}  // namespace gliss::tools
