#include "gliss/query/trace.h"

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/require.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/tick_time.h"

namespace gliss {
namespace {

void check(const TraceOptions& options, std::size_t hips) {
  require(is_stiffness(options.stiffness), "TraceOptions has a stiffness that is not 0 or more");
  if (const char* fault = fault_of(options.effects))
    throw std::invalid_argument(std::string("TraceOptions ") + fault);
  require(options.times.empty() || options.times.size() == hips,
          "TraceOptions has times that are not as many as HIPs");
  require(options.velocities.empty() || options.velocities.size() == hips,
          "TraceOptions has velocities that are not as many as HIPs");
}

std::chrono::nanoseconds time_of(const TraceOptions& options, std::size_t tick) {
  constexpr std::chrono::nanoseconds kTick = std::chrono::milliseconds(1);
  static_assert(std::chrono::duration<double>(kTick).count() == ContactTracker::kTick);
  return options.times.empty() ? static_cast<std::int64_t>(tick) * kTick : options.times[tick];
}

}  // namespace

std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                   const TraceOptions& options, const TraceSink& sink) {
  const PlainArithmetic plain;
  check(options, hips.size());
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
  const std::vector<PathLoop> loops = closed_loops(hips, options.poll);
  std::vector<LoopMeter> meters(options.methods.size(), LoopMeter(loops, options.stiffness));
  std::vector<TraceStep> steps(options.methods.size());
  for (std::size_t tick = 0, last = 0; tick < hips.size(); ++tick) {
    const bool is_somewhere = hips[tick].allFinite();
    const double dt = tick_time(time_of(options, last), time_of(options, tick));
    if (is_somewhere) last = tick;
    if (effects && is_somewhere)
      effects->see(hips[tick], dt,
                   options.velocities.empty() ? Vec3(Vec3::Zero()) : options.velocities[tick]);
    for (std::size_t m = 0; m < trackers.size(); ++m) {
      const Contact& contact = steps[m].contact = trackers[m].tick(hips[tick], dt);
      steps[m].force = is_somewhere
                           ? force_of(effects, contact, trackers[m], cache, options.stiffness)
                           : Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
      steps[m].cone_share = trackers[m].cone_share();
      statistics[m].add(steps[m].contact.touching, steps[m].force,
                        is_settling(steps[m].contact.flags));
      statistics[m].slipping += is_slipping(steps[m].contact.flags);
      meters[m].add(cache.unit * hips[tick], steps[m].force);
    }
    if (sink) sink(tick, steps);
  }
  for (std::size_t m = 0; m < meters.size(); ++m) {
    statistics[m].work = meters[m].work();
    statistics[m].loop_gain = meters[m].largest();
  }
  return statistics;
}

}  // namespace gliss
