#include "gliss/query/trace.h"

#include <optional>
#include <stdexcept>
#include <string>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/contact_tracker.h"

namespace gliss {

std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                   const TraceOptions& options, const TraceSink& sink) {
  const PlainArithmetic plain;
  if (const char* fault = fault_of(options.effects))
    throw std::invalid_argument(std::string("TraceOptions ") + fault);
  std::vector<ContactTracker> trackers;
  std::vector<TraceStatistics> statistics;
  for (const Method method : options.methods) {
    QueryOptions query{options, method};
    query.settle = options.settle;
    query.friction = options.friction;
    trackers.emplace_back(cache, query);
    statistics.emplace_back();
    statistics.back().method = method;
  }
  std::optional<Effects> effects;
  if (options.effects.any()) effects.emplace(options.effects, options.stiffness, cache.unit);
  const std::vector<PathLoop> loops = closed_loops(hips);
  std::vector<LoopGain> gains(options.methods.size(), LoopGain(loops));
  std::vector<TraceStep> steps(options.methods.size());
  for (std::size_t tick = 0; tick < hips.size(); ++tick) {
    if (effects) effects->see(hips[tick]);
    for (std::size_t m = 0; m < trackers.size(); ++m) {
      const Contact& contact = steps[m].contact = trackers[m].tick(hips[tick]);
      steps[m].force = force_of(effects, contact, trackers[m], cache, options.stiffness);
      steps[m].cone_share = trackers[m].cone_share();
      statistics[m].add(steps[m].contact.touching, steps[m].force,
                        is_settling(steps[m].contact.flags));
      statistics[m].slipping += is_slipping(steps[m].contact.flags);
      gains[m].add(cache.unit * hips[tick], steps[m].force);
    }
    if (sink && !sink(tick, steps)) break;
  }
  for (std::size_t m = 0; m < gains.size(); ++m) {
    statistics[m].work = gains[m].work();
    statistics[m].loop_gain = gains[m].largest();
  }
  return statistics;
}

}  // namespace gliss
