// Costs and gains of each level on a mesh and a machine, beside flat polygons and force shading.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/engine/engine.h"
#include "gliss/surface/names.h"
#include "gliss/sweep/surface_picture.h"
#include "gliss/walk/fidelity.h"
#include "gliss/walk/leaving_walk.h"
#include "gliss/walk/walk.h"

namespace gliss {

// A surface to compare: patches at a level, or the base polygons with a method.
struct CompareCandidate {
  Method method = Method::kGregory;
  Level level;

  bool operator==(const CompareCandidate&) const = default;
  std::string name() const {
    return method == Method::kGregory ? full_surface_name(level) : method_name(method);
  }
  // The old name, until 0.3.
  std::string level_name() const {
    return method == Method::kGregory ? surface_name(level) : method_name(method);
  }
};

struct CompareOptions {
  std::vector<CompareCandidate> candidates;
  // False: the mesh's normals were made for it, so that each construction makes its own.
  bool normals_given = true;
  // The mesh of the methods flat and shaded, which must outlive the comparison; null: the same. A
  // mesh with creases has one normal a vertex here: where normals differ across an edge, those that
  // shading blends jump.
  const Mesh* baseline = nullptr;
  std::vector<Precision> precisions{Precision::kFloat, Precision::kDouble};
  std::vector<Solver> solvers{Solver::kNewton};
  std::vector<std::string> backends{"tbb"};
  // Makes the engine of a backend; null: those of "tbb" and "serial" are known.
  std::function<std::unique_ptr<Engine>(const std::string& backend)> make_engine = nullptr;
  SolverOptions solving;       // but for the solver
  double settle = 0;           // s, as in QueryOptions; by default leaps show
  double stiffness = 500;      // N/m
  std::size_t most_jumps = 0;  // that a row tells the places of
  Poll poll = {};
};

// How walks feel, by their speed and by `settle`.
struct CompareWalk {
  double way = 0;     // m, a tick
  double settle = 0;  // s
  FeltWalks felt{};   // mesh's unit for N
};

// Lengths in m. What was not measured is NaN: a JSON null.
struct CompareRow {
  CompareCandidate candidate;
  Precision precision;
  Solver solver;
  std::string backend;
  double bytes = 0, bytes_per_patch = 0;
  double build_per_s = 0, eval_per_s = 0, track_per_s = 0;
  double max_distance = 0, p99_distance = 0;                // to its construction's exact surface
  double true_max_distance = 0, true_p99_distance = 0;      // to the reference
  double max_normal_gap = 0, p99_normal_gap = 0;            // rad
  double max_force_step = 0, p99_force_step = 0;            // N, along the path
  double walk_max_force_step = 0, walk_p99_force_step = 0;  // N, in the first walks
  double jumps_per_100k = 0, lost_per_100k = 0;             // as well; without, along the path
  double settling_share = 0;                                // of the ticks in contact; as the jumps
  double steps_beyond_2dx_per_100k = 0, max_step_beyond_2dx = 0;  // in the walks (FeltWalks); N
  HeldContacts leaving{};                                         // of CompareWalks::leaving
  LoopGain loop_gain{};                                           // of CompareWalks::loops
  std::uint64_t unsound = 0;                                      // steps that are not finite
  // The error is to the force of that surface, as a share of stiffness x depth.
  double max_force_error = 0, p99_force_error = 0;
  double tick = 0;  // s, median
  bool pareto = false;
  std::vector<CompareWalk> walks{};  // each of CompareWalks::sets with settle 0 and above 0
  std::vector<WalkJump> jumps{};     // in the first walks, the largest first
};

// A triangle mesh so dense that it feels as smooth as `target`, or the densest that was tried.
struct DenseRow {
  Method method = Method::kFlat;
  std::uint64_t triangles = 0;
  double bytes = 0, max_force_step = 0, p99_force_step = 0, tick = 0;
  double jumps_per_100k = 0, lost_per_100k = 0;  // along the path
  std::string target;
  double target_step = 0, memory_ratio = 0, time_ratio = 0;
  bool reached = false;
  // The number that the last two tried suggest where none reached it; NaN: no end in sight.
  double needed_triangles = 0;
};

// HIPs at one depth.
struct ComparePath {
  double depth = 0;          // m
  std::vector<Vec3> hips{};  // mesh's unit
};

// Random walks at one speed.
struct WalkSet {
  double step = 0.01;  // of the depth, a tick
  std::vector<Walk> walks{};
};

// Random walks, all at one depth, and hands that leave; none: they are switched off.
struct CompareWalks {
  double depth = 0;             // m
  std::vector<WalkSet> sets{};  // what a row says of walks without a speed is of the first
  std::vector<std::vector<Vec3>> loops{};    // loop_paths, as deep
  std::vector<std::vector<Vec3>> leaving{};  // leaving_paths, of any depth
};

// `distance`: from a point (mesh's unit) to the true surface, same unit; null: unknown.
using TrueDistance = std::function<double(const Vec3&)>;

class GLISS_EXPORT Comparison {
 public:
  // The mesh has normals, and one path at least. Mesh and topology must outlive it. Builds the
  // exact surface of each construction that a candidate has, in double.
  Comparison(const Mesh& mesh, const Topology& topology, std::vector<ComparePath> paths,
             CompareWalks walks, TrueDistance distance, CompareOptions options);
  Comparison(Mesh&&, const Topology&, std::vector<ComparePath>, CompareWalks, TrueDistance,
             CompareOptions) = delete;
  Comparison(const Mesh&, Topology&&, std::vector<ComparePath>, CompareWalks, TrueDistance,
             CompareOptions) = delete;

  // The exact surface of each construction, as pictures of at most `most_points`.
  std::vector<std::pair<Construction, SurfacePicture>> pictures(std::size_t most_points) const;

  const CompareWalks& walks() const { return walks_; }
  std::size_t row_count() const;
  // Calls `measured` after each row.
  std::vector<CompareRow> measure(const std::function<void()>& measured = nullptr) const;
  // Finer and finer triangles of at most `limit`.
  DenseRow match(Method method, const CompareRow& target, std::uint64_t limit) const;

 private:
  struct Surface;
  // The exact surface of a construction, against which its rows are measured.
  struct Exact {
    Construction construction;
    PatchCache cache;
    std::vector<SurfacePoint> points{};       // at points_
    std::vector<std::vector<Vec3>> pushes{};  // [path][tick], mesh's unit
  };

  ParallelFor polled(const Engine& engine) const;  // that of the engine, with polls
  void add_exact(Construction construction);
  const Exact* find_exact(Construction construction) const;  // null: not added
  const Mesh& mesh_of(Construction construction) const;
  // The baselines are measured against the construction of the first candidate that has one.
  const Exact& exact_of(const CompareCandidate& candidate) const;
  std::unique_ptr<Engine> engine_of(const std::string& backend) const;
  Surface build(const CompareCandidate& candidate, Precision precision, const Engine& engine) const;
  void measure_shape(const Surface& surface, const Engine& engine, CompareRow& row) const;
  void measure_feel(const PatchCache& cache, const QueryOptions& query, const Exact& exact,
                    CompareRow& row) const;
  void measure_walks(const PatchCache& cache, const QueryOptions& query, const Engine& engine,
                     CompareRow& row) const;
  // Makes `felt` the figures of the row's walks without a speed.
  void take_walks(const FeltWalks& felt, CompareRow& row) const;
  double evaluation_rate(const ResidentSurface& resident) const;
  double tracking_rate(const ResidentSurface& resident, const QueryOptions& query) const;
  QueryOptions query_of(const CompareCandidate& candidate, Solver solver) const;

  const Mesh& mesh_;
  const std::vector<ComparePath> paths_;
  const CompareWalks walks_;
  const TrueDistance distance_;
  const CompareOptions options_;
  const Topology& topology_;
  Mesh smooth_mesh_;  // with the fair construction's normals, if it makes its own
  std::vector<Exact> exact_;
  std::vector<DomainPoint> points_, many_points_;  // many: for the rate of evaluation
  std::vector<Vec3> hips_;                         // beneath points_
};

}  // namespace gliss
