// Patches only where the hand is (Algorithm 1, Figure 6): those of the faces around the contact,
// built when it comes near. For meshes too large, or too short-lived, to build as a whole.
#pragma once

#include <memory>

#include "host/query.h"
#include "host/topology.h"

namespace gliss {

struct LazyOptions {
  int rings = 3;  // faces within so many edges of the contact are built; at least 2
  Precision precision = Precision::kDouble;
  QueryOptions query;  // method: kGregory
};

// One HIP on one mesh. Free, the nearest base polygon of the whole mesh is found first (4.1), then
// its patches are built and the nearest point of those is taken. Building happens inside tick(),
// which therefore may allocate.
class LazyTracker {
 public:
  // The mesh must be validated; vertex normals are made where it has none.
  LazyTracker(Mesh mesh, const LazyOptions& options = {});
  Contact tick(const Vec3& hip);

  const PatchCache& region() const {
    return *region_;
  }                                               // what is built now; requires a tick before
  std::uint64_t built() const { return built_; }  // patches built so far

 private:
  void build_around(std::uint32_t face);
  bool near_rim(std::uint32_t face) const;
  std::uint32_t nearest_face(const Vec3& hip) const;

  Mesh mesh_;
  Topology topology_;
  LazyOptions options_;
  PatchCache base_;  // base polygons only
  std::unique_ptr<PatchCache> region_;
  std::unique_ptr<ContactTracker> tracker_;
  std::uint64_t built_ = 0;
};

}  // namespace gliss
