// A recorded path of HIPs, tracked tick by tick (Algorithm 1) with each method, as the device loop
// would.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/query/force_statistics.h"
#include "gliss/query/query.h"
#include "gliss/query/work.h"

namespace gliss {

struct TraceOptions : SolverOptions {
  std::vector<Method> methods{Method::kGregory, Method::kShaded, Method::kFlat};
  double stiffness = 500;                 // N/m
  double settle = QueryOptions{}.settle;  // ticks
};

struct TraceStep {
  Contact contact;
  Vec3 force;  // N
};

struct TraceStatistics : ForceStatistics {
  Method method = Method::kGregory;
  Work work;           // of the force on the hand, J
  double loop_gain{};  // LoopGain::largest, of the path's closed_loops
};

// Takes steps in order, all methods of a tick together (steps[i] belongs to options.methods[i]).
// False stops the trace.
using TraceSink = std::function<bool(std::size_t tick, std::span<const TraceStep> steps)>;

// HIPs in the mesh's unit.
GLISS_EXPORT std::vector<TraceStatistics> trace(const PatchCache& cache, std::span<const Vec3> hips,
                                                const TraceOptions& options,
                                                const TraceSink& sink = nullptr);

}  // namespace gliss
