// Random walks beneath a mesh, and how smooth they feel: a finger that presses in anywhere and
// slides on at one depth, turning slowly. Unlike a chosen path they meet every part of a surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/parallel.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/topology.h"
#include "gliss/query/force_statistics.h"
#include "gliss/query/query.h"
#include "gliss/query/work.h"

namespace gliss {

struct WalkOptions {
  double depth = 0;    // mesh's unit, like walk_depth
  double step = 0.01;  // of the depth, a tick: 0.01 stands for a loop of 1000 Hz, 0.1 for 100 Hz
  std::size_t walkers = 100, ticks = 2500;  // ticks of a walker, those of pressing in left out
  std::uint64_t seed = 1;
};

// 0.5 % of the diagonal of the mesh's bounding box: the usual depth of walks.
GLISS_EXPORT double walk_depth(const Mesh& mesh);

// The HIPs of one walk, one a tick, in the mesh's unit. The first kEntry lead from the open, 2 % of
// the bounding box's diagonal above the mesh, straight to the depth.
struct Walk {
  static constexpr std::size_t kEntry = 20;
  std::vector<Vec3> hips;
};

// Walks that know the base mesh alone, so that every surface made from it gets the very same HIPs.
// A walk starts above a point chosen by area. A guide, which is a tracker of force shading, tells
// normal and depth; the HIP moves by `step` along a tangent that wanders, and by at most a fifth of
// that towards the depth. A walk ends where the guide loses contact, or is held three times as deep
// because the HIP has gone through a thin part, and its walker starts again elsewhere until it has
// all its ticks. Deterministic by the seed, on any number of threads; the walks of fewer walkers
// are the first of those of more. The mesh must have vertex normals.
GLISS_EXPORT std::vector<Walk> walk_paths(const Mesh& mesh, const Topology& topology,
                                          const WalkOptions& options,
                                          const ParallelFor& parallel = serial_for);

// A jump of force on a walk (ForceStatistics).
struct WalkJump {
  Vec3 scp;  // that the force leaves, or finds where it gains contact; mesh's unit
  std::uint32_t face = 0;
  double step = 0;    // of the full force
  bool lost = false;  // the contact ends
};

struct FeltWalks : ForceStatistics {
  double p99_step = 0;      // of the steps
  double jump_squares = 0;  // sum of (jumps of a walk)^2
  // Steps that exceed twice the HIP's way, which a quick hand has without a leap; by how much, at
  // most. A step that is not finite is among them.
  std::uint64_t steps_beyond_2dx = 0;
  double largest_beyond_2dx = 0;

  void add_beyond(double excess) noexcept {
    steps_beyond_2dx += excess > 0;
    largest_beyond_2dx = std::max(largest_beyond_2dx, excess);
  }
  // Adds one walk.
  void merge(const FeltWalks& other) noexcept {
    ForceStatistics::merge(other);
    const auto jumps = static_cast<double>(other.jumps());
    jump_squares += jumps * jumps;
    steps_beyond_2dx += other.steps_beyond_2dx;
    largest_beyond_2dx = std::max(largest_beyond_2dx, other.largest_beyond_2dx);
  }
  double steps_beyond_2dx_per_100k() const noexcept {
    return per_100k(static_cast<double>(steps_beyond_2dx));
  }
  // The standard deviation over seeds of jumps_per_100k, as the walks tell it, whose jumps come in
  // bursts; one jump at least, for where none was seen there may be one.
  double jumps_spread_per_100k() const noexcept {
    return per_100k(std::sqrt(std::max(1.0, jump_squares)));
  }
};
// Counts what a tracker of its own feels on each walk; stiffness 1 N per unit of length, full
// force `depth` (mesh's unit). Ticks of pressing in are not counted. Adds to `jumps`, unless it is
// null, the jumps that are sound, walk by walk.
GLISS_EXPORT FeltWalks feel_walks(const PatchCache& cache, const QueryOptions& options,
                                  std::span<const Walk> walks, double depth,
                                  const ParallelFor& parallel = serial_for,
                                  std::vector<WalkJump>* jumps = nullptr);

// Closed loops of HIPs beneath a mesh, to tell if a force makes energy: circles about as wide as a
// face, every other one backwards, in planes `depth` beneath places chosen by area, each twice
// round: the second round ends as it began. `count` of them, deterministic by the seed.
GLISS_EXPORT std::vector<std::vector<Vec3>> loop_paths(const Mesh& mesh, const Topology& topology,
                                                       double depth, std::size_t count,
                                                       std::uint64_t seed = 1);

// The gain of the second round (LoopMeter) on that loop of loop_paths, of those that stay in
// contact, where it exceeds its error by most; NaN: there is none. `poll` is called before each
// loop, and may end it by throwing.
GLISS_EXPORT LoopGain loop_gain(const PatchCache& cache, const QueryOptions& options,
                                std::span<const std::vector<Vec3>> loops, const Poll& poll = {});

}  // namespace gliss
