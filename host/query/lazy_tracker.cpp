#include "gliss/query/lazy_tracker.h"

namespace gliss {

LazyTracker::LazyTracker(Mesh mesh, const LazyOptions& options, const QueryOptions& query)
    : mesh_(std::move(mesh), options), query_(query) {}

void LazyTracker::build_around(std::uint32_t face) {
  tracker_.reset();
  region_ = std::make_unique<LazyRegion>(mesh_.build({&face, 1}));
  tracker_ = std::make_unique<ContactTracker>(region_->cache, query_);
  built_ += region_->cache.patch_count();
}

std::uint32_t LazyTracker::nearest_face(const Vec3& hip) const {
  QueryOptions flat;
  flat.method = Method::kFlat;
  return nearest(mesh_.base(), hip, flat).at.face;
}

Contact LazyTracker::tick(const Vec3& hip, double dt) {
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

}  // namespace gliss
