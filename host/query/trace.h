// A recorded path of HIPs, tracked tick by tick (Algorithm 1) with each method, as the device loop
// would.
#pragma once

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
  double stiffness = 500;                 // N/m
  double settle = QueryOptions{}.settle;  // ticks
  FrictionOptions friction = {};
  EffectOptions effects = {};
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
  double loop_gain{};          // LoopGain::largest, of the path's closed_loops

  // The share of the ticks in contact that slip; 0 where there was none.
  double slipping_share() const noexcept { return per_100k(slipping) * 1e-5; }
};

// Takes steps in order, all methods of a tick together (steps[i] belongs to options.methods[i]).
// False stops the trace.
using TraceSink = std::function<bool(std::size_t tick, std::span<const TraceStep> steps)>;

// HIPs in the mesh's unit. Throws std::invalid_argument as ContactTracker does,
// and for effects that are none.
GLISS_EXPORT std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                                const TraceOptions& options,
                                                const TraceSink& sink = nullptr);

}  // namespace gliss
