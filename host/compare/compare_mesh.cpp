#include "gliss/compare/compare_mesh.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "gliss/build/build_cache.h"
#include "gliss/build/complete_mesh.h"
#include "gliss/walk/fidelity.h"

namespace gliss {
namespace {

constexpr std::size_t kLoops = 40;  // closed ones
constexpr std::size_t kHandsAWalk = 5;
constexpr double kFaster = 10;  // than the slow walks are the fast ones

double diagonal_of(const PatchCache& cache) {
  const Box box = cache.bounds();
  return (box.high - box.low).norm();
}

std::vector<ComparePath> make_paths(const ComparedMesh& compared, const PatchCache& surface,
                                    MeshComparisonOptions& options) {
  const double diagonal = diagonal_of(surface), unit = compared.mesh.unit;
  std::vector<ComparePath> paths;
  if (!options.hips.empty()) {
    paths.push_back({options.depths.front(), std::move(options.hips)});
    return paths;
  }
  for (const double depth : options.depths) {
    paths.push_back({depth, path_over(compared.mesh, compared.topology, surface, depth / unit,
                                      diagonal / 1000, options.ticks, options.measuring.poll)});
  }
  return paths;
}

CompareWalks make_walks(const ComparedMesh& compared, const MeshComparisonOptions& options,
                        const Engine& engine) {
  const Mesh& mesh = compared.baseline();
  const ParallelFor parallel = engine.build_backend().parallel;
  CompareWalks made;
  made.leaving = leaving_paths(mesh, compared.topology, leaving_of(options), parallel);
  if (options.walk.walkers == 0) return made;
  made.depth = options.walk_depth > 0 ? options.walk_depth : walk_depth(mesh) * mesh.unit;
  WalkOptions walk = options.walk;
  walk.depth = made.depth / mesh.unit;
  for (const double times : {1.0, kFaster}) {
    walk.step = std::min(1.0, times * options.walk.step);
    made.sets.push_back({walk.step, walk_paths(mesh, compared.topology, walk, parallel)});
  }
  made.loops = loop_paths(mesh, compared.topology, walk.depth, kLoops, walk.seed);
  return made;
}

}  // namespace

ComparedMesh::ComparedMesh(Mesh validated)
    : mesh(std::move(validated)), normals_given(!mesh.normals.empty()) {
  if (!mesh.sharp.empty()) {
    smooth_ = mesh;
    smooth_.sharp.clear();
    add_vertex_normals(smooth_);
  }
  topology = complete_mesh(mesh, Construction::kPaper);
}

double compared_depth(const PatchCache& surface) {
  return 0.01 * diagonal_of(surface) * surface.unit;
}

const std::vector<CompareCandidate>& all_candidates() {
  static const std::vector<CompareCandidate> all = {
      {Method::kGregory, {.construction = Construction::kFair}},
      {Method::kGregory, {Level::kExact, 0, Construction::kPaper}},
      {Method::kGregory, {Level::kRibbon, 0, Construction::kPaper}},
      {Method::kGregory, {Level::kBezier, 0, Construction::kPaper}},
      {Method::kGregory, {Level::kTable, kTableCells, Construction::kPaper}},
      {Method::kShaded, {}},
      {Method::kFlat, {}}};
  return all;
}

std::optional<CompareCandidate> find_candidate(const std::string& name) {
  for (const Method method : {Method::kShaded, Method::kFlat}) {
    if (name == method_name(method)) return CompareCandidate{method, {}};
  }
  if (const auto level = find_surface(name)) return CompareCandidate{Method::kGregory, *level};
  return std::nullopt;
}

LeavingOptions leaving_of(const MeshComparisonOptions& options) {
  return {options.leaving.value_or(kHandsAWalk * options.walk.walkers),
          100 + 2 * held_bound(options.measuring.settle), options.walk.seed};
}

Comparison compare_mesh(const ComparedMesh& compared, const PatchCache& surface,
                        MeshComparisonOptions options, const Engine& engine) {
  options.measuring.normals_given = compared.normals_given;
  options.measuring.baseline = &compared.baseline();
  std::vector<ComparePath> paths = make_paths(compared, surface, options);
  CompareWalks walks = make_walks(compared, options, engine);
  return {compared.mesh,    compared.topology, std::move(paths),
          std::move(walks), options.truth,     std::move(options.measuring)};
}

const CompareRow* smoothest(const std::vector<CompareRow>& rows) {
  const CompareRow* best = nullptr;
  for (const CompareRow& row : rows) {
    if (row.candidate.method != Method::kGregory) continue;
    if (best == nullptr) best = &row;
    if (row.candidate.level == Level{} && row.precision == Precision::kDouble) return &row;
  }
  return best;
}

std::vector<DenseRow> match_dense(const Comparison& comparison, const std::vector<CompareRow>& rows,
                                  std::uint64_t most_triangles,
                                  const std::function<void()>& matched) {
  std::vector<DenseRow> dense;
  const CompareRow* target = smoothest(rows);
  if (target == nullptr || most_triangles == 0) return dense;
  for (const Method method : {Method::kShaded, Method::kFlat}) {
    const bool wanted = std::any_of(rows.begin(), rows.end(), [&](const CompareRow& row) {
      return row.candidate.method == method;
    });
    if (wanted) dense.push_back(comparison.match(method, *target, most_triangles));
    if (matched) matched();
  }
  return dense;
}

}  // namespace gliss
