// One HIP on a mesh whose patches are built when the contact comes near, within the tick
// (Algorithm 1, Figure 6). For meshes too large, or too short-lived, to build as a whole, where no
// tick has to be on time; runtime/contact/lazy_contact.h is for a device.
#pragma once

#include <memory>

#include "gliss/base/export.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/lazy_mesh.h"

namespace gliss {

// Free, the nearest base polygon of the whole mesh is found first (4.1), then its patches are built
// and the nearest point of those is taken. A tick may therefore allocate.
class GLISS_EXPORT LazyTracker {
 public:
  // The mesh must be validated; HIPs and contacts are in its unit. query.method: kGregory.
  explicit LazyTracker(Mesh mesh, const LazyOptions& options = {}, const QueryOptions& query = {});
  Contact tick(const Vec3& hip, double dt = ContactTracker::kTick);

  // The patches that are built now, until the next tick; requires a tick before.
  const PatchCache& region() const { return region_->cache; }
  std::uint64_t built() const { return built_; }  // patches built so far

 private:
  void build_around(std::uint32_t face);
  std::uint32_t nearest_face(const Vec3& hip) const;

  LazyMesh mesh_;
  QueryOptions query_;
  std::unique_ptr<LazyRegion> region_;
  std::unique_ptr<ContactTracker> tracker_;
  std::uint64_t built_ = 0;
};

}  // namespace gliss
