// A recorded path of HIPs, tracked tick by tick (Algorithm 1) with each method, as the device loop
// would.
#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/query/effects.h"
#include "gliss/query/force_statistics.h"
#include "gliss/query/query.h"
#include "gliss/query/work.h"

namespace gliss {

struct TraceOptions : SolverOptions {
  std::vector<Method> methods{Method::kGregory, Method::kShaded, Method::kFlat};
  double stiffness = 500;                 // N/m, 0 or more
  double settle = QueryOptions{}.settle;  // s
  FrictionOptions friction = {};
  EffectOptions effects = {};
  // When each HIP was there, since any start, as Tracker::step takes it; none: each is
  // ContactTracker::kTick after the one before.
  std::span<const std::chrono::nanoseconds> times = {};
  // The device's own velocity at each HIP (m/s), for effects; none: it tells none.
  std::span<const Vec3> velocities = {};
  Poll poll = {};  // asked before the first tick; then the sink is
};

struct TraceStep {
  Contact contact;
  Vec3 force;             // N
  double cone_share = 0;  // ContactTracker::cone_share
};

struct TraceStatistics : ForceStatistics {
  Method method = Method::kGregory;
  std::uint64_t slipping = 0;  // ticks in contact with kSlipping
  Work work;                   // of the force on the hand, J
  LoopGain loop_gain{};        // LoopMeter::largest, of the path's closed_loops

  // The share of the ticks in contact that slip; 0 where there was none.
  double slipping_share() const noexcept { return per_100k(slipping) * 1e-5; }
};

// Takes steps in order, all methods of a tick together (steps[i] belongs to options.methods[i]).
// It ends the trace by throwing.
using TraceSink = std::function<void(std::size_t tick, std::span<const TraceStep> steps)>;

// HIPs in the mesh's unit. The force at one that is not finite is NaN, and nothing else comes of
// it. Throws std::invalid_argument as ContactTracker does, for a stiffness or effects that are
// invalid, and for times or velocities that are not as many as HIPs.
GLISS_EXPORT std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                                const TraceOptions& options,
                                                const TraceSink& sink = nullptr);

}  // namespace gliss
