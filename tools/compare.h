// Costs and gains of each level on a mesh and a machine, beside flat polygons and force shading.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/fidelity.h"
#include "host/walk.h"
#include "tools/command.h"
#include "tools/watch.h"

namespace gliss::tools {

// A surface to compare: patches at a level, or the base polygons with a method.
struct Candidate {
  Method method = Method::kGregory;
  Level level;

  bool operator==(const Candidate&) const = default;
  std::string name() const {
    return method == Method::kGregory ? level_name(level) : method_name(method);
  }
};

struct CompareOptions {
  std::vector<Candidate> candidates;
  std::vector<Precision> precisions{Precision::kFloat, Precision::kDouble};
  std::vector<Solver> solvers{Solver::kNewton};
  std::vector<std::string> backends{"tbb"};
  SolverOptions solving;   // but for the solver
  double stiffness = 500;  // N/m
};

// Lengths in m. What was not measured is NaN: a JSON null.
struct CompareRow {
  Candidate candidate;
  Precision precision;
  Solver solver;
  std::string backend;
  double bytes = 0, bytes_per_patch = 0;
  double build_per_s = 0, eval_per_s = 0, track_per_s = 0;
  double max_distance = 0, p99_distance = 0;            // to the exact surface
  double true_max_distance = 0, true_p99_distance = 0;  // to the reference
  double max_normal_gap = 0, p99_normal_gap = 0;        // rad
  double max_force_step = 0, p99_force_step = 0;        // N, along the path
  double walk_max_force_step = 0;                       // N, in the walks
  double jumps_per_100k = 0, lost_per_100k = 0;         // in the walks; without, along the path
  std::uint64_t unsound = 0;                            // steps that are not finite
  // The error is to the force of the exact surface, as a share of stiffness x depth.
  double max_force_error = 0, p99_force_error = 0;
  double tick = 0;  // s, median
  bool pareto = false;
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
  double needed_triangles =
      0;  // where not reached: as the last two tried say; NaN: no end in sight
};

struct Budget {
  std::optional<double> force_error, tick, memory;  // ratio, s, bytes
};

// HIPs at one depth.
struct ComparePath {
  double depth = 0;                   // m
  std::vector<Vec3> hips, reference;  // mesh's unit; pushes of the exact surface
};

// Random walks, all at one depth; none: they are switched off.
struct CompareWalks {
  double depth = 0;  // m
  std::vector<Walk> walks{};
};

// `distance`: from a point (mesh's unit) to the true surface, same unit; null: unknown.
using TrueDistance = std::function<double(const Vec3&)>;

class Comparison {
 public:
  // `exact`: in double, of the whole mesh; the mesh has normals.
  Comparison(const Mesh& mesh, const Topology& topology, const PatchCache& exact,
             std::vector<ComparePath> paths, CompareWalks walks, const TrueDistance& distance,
             const CommonOptions& common, const CompareOptions& options);

  std::size_t row_count() const;
  std::vector<CompareRow> measure(Watch& watch) const;
  // Finer and finer triangles of at most `limit`.
  DenseRow match(Method method, const CompareRow& target, std::uint64_t limit) const;

 private:
  struct Surface;

  Surface build(const Candidate& candidate, Precision precision, const Engine& engine) const;
  void measure_shape(const Surface& surface, CompareRow& row) const;
  void measure_feel(const PatchCache& cache, const QueryOptions& query, CompareRow& row) const;
  void measure_walks(const PatchCache& cache, const QueryOptions& query, const Engine& engine,
                     CompareRow& row) const;
  double evaluation_rate(const ResidentSurface& resident) const;
  double tracking_rate(const ResidentSurface& resident, const QueryOptions& query) const;
  QueryOptions query_of(const Candidate& candidate, Solver solver) const;

  const Mesh& mesh_;
  const PatchCache& exact_;
  const std::vector<ComparePath> paths_;
  const CompareWalks walks_;
  const TrueDistance distance_;
  const CommonOptions& common_;
  const CompareOptions& options_;
  const Topology& topology_;
  const std::vector<DomainPoint> points_, many_points_;  // many: for the rate of evaluation
  std::vector<SurfacePoint> exact_points_;               // at points_
  std::vector<Vec3> hips_;                               // beneath them
};

// Marks rows that no other beats in error, tick and memory at once.
void mark_pareto(std::vector<CompareRow>& rows);
// The quickest of the rows within the budget, or the nearest to the exact surface where no error is
// given; null: none.
const CompareRow* recommend(const std::vector<CompareRow>& rows, const Budget& budget);

}  // namespace gliss::tools
