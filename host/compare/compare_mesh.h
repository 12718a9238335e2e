// A comparison of a mesh's surfaces with all that it takes: paths, walks and hands on the mesh.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/compare/compare.h"
#include "gliss/engine/engine.h"
#include "gliss/walk/leaving_walk.h"
#include "gliss/walk/walk.h"

namespace gliss {

// The mesh completed, and the same without its creases if it has any: walks and baselines are the
// same with creases and without.
class GLISS_EXPORT ComparedMesh {
 public:
  explicit ComparedMesh(Mesh validated);

  const Mesh& baseline() const { return mesh.sharp.empty() ? mesh : smooth_; }

  Mesh mesh;
  bool normals_given;
  Topology topology;

 private:
  Mesh smooth_;
};

struct MeshComparisonOptions {
  CompareOptions measuring;        // but for what the mesh says; see all_candidates()
  std::vector<double> depths;      // m, one at least; compared_depth() is the usual one
  std::vector<Vec3> hips;          // a path at the first depth, mesh's unit; empty: one of its own
  std::size_t ticks = 4000;        // of its own path, a thousandth of the diagonal apart
  WalkOptions walk{.walkers = 8};  // slow ones; its depth is not used
  double walk_depth = 0;           // m; 0: 0.5 % of the diagonal
  std::optional<std::size_t> leaving{};  // hands; 5 for each walk by default
  TrueDistance truth = nullptr;
};

// A hundredth of the diagonal of the bounding box, m.
GLISS_EXPORT double compared_depth(const PatchCache& surface);

// Fair and paper, the paper's other levels, shaded and flat.
GLISS_EXPORT const std::vector<CompareCandidate>& all_candidates();

// "fair", "paper-ribbon", "shaded"; none for other names (no_surface).
GLISS_EXPORT std::optional<CompareCandidate> find_candidate(const std::string& name);

// The hands of a comparison. They rest for twice as long as a contact may go on, and longer.
GLISS_EXPORT LeavingOptions leaving_of(const MeshComparisonOptions& options);

// `surface`: any patches of the mesh; the engine makes the walks. The mesh must outlive it. Throws
// std::invalid_argument where no path leads over the mesh (path_over).
GLISS_EXPORT Comparison compare_mesh(const ComparedMesh& compared, const PatchCache& surface,
                                     MeshComparisonOptions options, const Engine& engine);

// The patches that dense triangles are to match: exact fair ones in double, if there are such; null
// without any patches.
GLISS_EXPORT const CompareRow* smoothest(const std::vector<CompareRow>& rows);

// Dense triangles as smooth as the smoothest patches, for those baselines that have a row.
// `matched` is called after each of the two. None without patches.
GLISS_EXPORT std::vector<DenseRow> match_dense(const Comparison& comparison,
                                               const std::vector<CompareRow>& rows,
                                               std::uint64_t most_triangles,
                                               const std::function<void()>& matched = nullptr);

}  // namespace gliss
