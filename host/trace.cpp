#include "host/trace.h"

#include <algorithm>

namespace gliss {

std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                   const TraceOptions& options, const TraceSink& sink) {
  std::vector<ContactTracker> trackers;
  std::vector<TraceStatistics> statistics;
  for (const Method method : options.methods) {
    QueryOptions query;
    query.method = method;
    query.solver = options.solver;
    trackers.emplace_back(cache, query);
    statistics.emplace_back();
    statistics.back().method = method;
  }
  std::vector<TraceStep> steps(options.methods.size()), last(options.methods.size());
  std::vector<std::uint64_t> pairs(options.methods.size(), 0);
  for (std::size_t tick = 0; tick < hips.size(); ++tick) {
    for (std::size_t m = 0; m < trackers.size(); ++m) {
      TraceStatistics& s = statistics[m];
      steps[m].contact = trackers[m].tick(hips[tick]);
      steps[m].force = force(cache, steps[m].contact, options.stiffness);
      ++s.ticks;
      s.touching += steps[m].contact.touching;
      s.largest_force = std::max(s.largest_force, steps[m].force.norm());
      const bool was_touching = tick > 0 && last[m].contact.touching;
      s.entries += steps[m].contact.touching && !was_touching;
      if (steps[m].contact.touching && was_touching) {
        const double step = (steps[m].force - last[m].force).norm();
        s.largest_step = std::max(s.largest_step, step);
        s.mean_step += step;
        ++pairs[m];
      }
    }
    if (sink && !sink(tick, steps)) break;
    std::swap(last, steps);
  }
  for (std::size_t m = 0; m < statistics.size(); ++m) {
    if (pairs[m] > 0) statistics[m].mean_step /= static_cast<double>(pairs[m]);
  }
  return statistics;
}

}  // namespace gliss
