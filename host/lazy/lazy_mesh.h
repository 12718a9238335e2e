// A mesh whose patches are built where they are wanted: around some faces at a time (Figure 6). It
// does not change, so that any number of threads may build from it.
#pragma once

#include <span>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/mesh/topology.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

struct LazyOptions {
  int rings = 3;  // faces within so many edges of the contact are built; at least 2
  Precision precision = Precision::kDouble;
  Level level{};
};

// Patches of a part of a mesh, with the bytes that they have in the cache of all. `used` are those
// with all their neighbours, corner to corner, so that a contact there does not see where the
// region ends; the others are the rim.
struct LazyRegion {
  PatchCache cache;
  std::vector<char> used;  // [patch]

  bool has(std::uint32_t face) const { return cache.first_patch(face) != kNone; }
  bool covers(std::uint32_t face) const { return has(face) && used[cache.first_patch(face)] != 0; }
};

class GLISS_EXPORT LazyMesh {
 public:
  // The mesh must be validated; vertex normals are made where it has none.
  explicit LazyMesh(Mesh mesh, const LazyOptions& options = {});

  // True if what is inside depends on patches that are far from a contact, so that all are wanted:
  // parts of the mesh lie within one another, or its faces fold over their neighbours.
  bool needs_all() const;
  // Base polygons only, of the whole mesh.
  const PatchCache& base() const { return base_; }
  const LazyOptions& options() const { return options_; }
  // No patch is farther than this from its base polygon, mesh's unit; but for patches that swell
  // beyond the size of their face.
  double reach() const { return reach_; }
  // Covers the faces within `rings` edges of these.
  LazyRegion build(std::span<const std::uint32_t> faces, const Poll& poll = {}) const;
  // True if the region covers the face and all those across its sides.
  bool is_inside(const LazyRegion& region, std::uint32_t face) const;

 private:
  Mesh mesh_;
  Topology topology_;
  LazyOptions options_;
  PatchCache base_;
  double reach_ = 0;
};

}  // namespace gliss
