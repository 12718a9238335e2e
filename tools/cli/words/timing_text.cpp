#include "tools/cli/words/timing_text.h"

#include <fmt/format.h>

namespace gliss::tools {
namespace {

Json bins_json(const DurationHistogram& h) {
  Json bins = Json::array();
  for (const auto& [longest, count] : h.bins())
    bins.push_back(Json::array({microseconds(longest), count}));
  return bins;
}

}  // namespace

double microseconds(Nanoseconds time) { return static_cast<double>(time.count()) / 1e3; }

Json json_of(const DurationHistogram& h) {
  return {{"p50_us", microseconds(h.quantile(0.5))},
          {"p99_us", microseconds(h.quantile(0.99))},
          {"p999_us", microseconds(h.quantile(0.999))},
          {"max_us", microseconds(h.max())}};
}

Json histograms_json(const TickRecord& record) {
  return {{"wake", bins_json(record.lateness())}, {"compute", bins_json(record.compute())}};
}

std::string timing_header() {
  return fmt::format("{:<8} {:>10} {:>10} {:>10} {:>10}\n", "us", "p50", "p99", "p99.9", "max");
}

std::string timing_row(const char* name, const DurationHistogram& h) {
  return fmt::format("{:<8} {:>10.1f} {:>10.1f} {:>10.1f} {:>10.1f}\n", name,
                     microseconds(h.quantile(0.5)), microseconds(h.quantile(0.99)),
                     microseconds(h.quantile(0.999)), microseconds(h.max()));
}

}  // namespace gliss::tools
