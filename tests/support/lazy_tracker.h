// A tracker whose patches are built when the contact comes near, within the tick: what LazyContact
// does with a worker, one step after another.
#pragma once

#include <memory>
#include <utility>

#include "gliss/lazy/lazy_mesh.h"
#include "gliss/query/contact_tracker.h"

namespace gliss::test {

// Free, the nearest base polygon of the whole mesh is found first (4.1), then its patches are built
// and the nearest point of those is taken.
class LazyTracker {
 public:
  explicit LazyTracker(Mesh mesh, const LazyOptions& options = {}, const QueryOptions& query = {})
      : mesh_(std::move(mesh), options), query_(query) {}

  Contact tick(const Vec3& hip, double dt = ContactTracker::kTick) {
    const bool touching = tracker_ != nullptr && tracker_->touching();
    if (!touching) {
      const std::uint32_t face = nearest_face(hip);
      if (region_ == nullptr || !mesh_.is_inside(*region_, face)) build_around(face);
    }
    const Settling felt = tracker_->felt();
    Contact contact = tracker_->tick(hip, dt);
    // At the rim the surface goes on where the region does not: build there and follow on.
    for (std::uint32_t last = kNone;
         !mesh_.is_inside(*region_, contact.at.face) && contact.at.face != last;) {
      last = contact.at.face;
      const Friction friction = tracker_->friction();
      build_around(last);
      contact = tracker_->track(hip, contact.at, touching ? &felt : nullptr,
                                contact.touching ? &friction : nullptr, dt);
    }
    return contact;
  }

  std::uint64_t built() const { return built_; }  // patches built so far

 private:
  void build_around(std::uint32_t face) {
    tracker_.reset();
    region_ = std::make_unique<LazyRegion>(mesh_.build({&face, 1}));
    tracker_ = std::make_unique<ContactTracker>(region_->cache, query_);
    built_ += region_->cache.patch_count();
  }
  std::uint32_t nearest_face(const Vec3& hip) const {
    QueryOptions flat;
    flat.method = Method::kFlat;
    return nearest(mesh_.base(), hip, flat).at.face;
  }

  LazyMesh mesh_;
  QueryOptions query_;
  std::unique_ptr<LazyRegion> region_;
  std::unique_ptr<ContactTracker> tracker_;
  std::uint64_t built_ = 0;
};

}  // namespace gliss::test
