#include "gliss/contact/lazy_contact.h"

#include <algorithm>
#include <utility>

namespace gliss {
namespace {

// Shaded: its normals and the patches' agree at the vertices, so that the force changes by a third
// of what it does with flat polygons when one stands in for the other. The border of the region
// would hold the contact back, by more with each tick.
QueryOptions on_base(QueryOptions query) {
  query.method = Method::kShaded;
  return query;
}

}  // namespace

LazyContact::LazyContact(std::shared_ptr<const LazyMesh> mesh, const QueryOptions& query,
                         LazyWorkerOptions options)
    : mesh_(std::move(mesh)),
      worker_(mesh_, std::move(options)),
      query_(query),
      base_(mesh_->base(), on_base(query)) {}

Contact LazyContact::tick(const Vec3& hip, double dt) noexcept {
  take_region();
  const Contact contact = place_ == Place::kFree        ? tick_free(hip, dt)
                          : place_ == Place::kOnPatches ? tick_on_patches(hip, dt)
                                                        : tick_on_base(hip, dt);
  face_ = contact.at.face;
  if (hip.allFinite()) last_ = hip;
  return contact;
}

bool LazyContact::set_friction(const FrictionOptions& friction) noexcept {
  if (!base_.set_friction(friction)) return false;
  query_.friction = friction;
  if (patches_) patches_->set_friction(friction);
  return true;
}

// A contact on patches goes on with the bytes that it has; it waits for a region that has its
// patch.
void LazyContact::take_region() noexcept {
  if (const LazyRegion* newest = worker_.take()) {
    if (next_ != nullptr) worker_.give_back(next_);
    next_ = newest;
  }
  if (next_ == nullptr) return;
  const bool here = place_ == Place::kOnPatches || covers(face_);
  if (region_ != nullptr && here && !next_->covers(face_)) return;
  if (patches_) {
    patches_->move_to(next_->cache);
  } else {
    patches_.emplace(next_->cache, query_);
    if (clear_ >= 0) patches_->release(last_, clear_);
  }
  if (region_ != nullptr) worker_.give_back(region_);
  region_ = next_;
  next_ = nullptr;
}

// True if the contact is what it would be with all patches: the region's own border does not hold
// it.
bool LazyContact::holds(const Contact& contact) const {
  return region_->covers(contact.at.face) || !(contact.flags & kOnBorder);
}

Contact LazyContact::keep(const Contact& contact, Place touched) noexcept {
  place_ = contact.touching ? touched : Place::kFree;
  clear_ = 0;
  return contact;
}

Contact LazyContact::stand_in(const Vec3& hip, Contact base) noexcept {
  if (patches_) patches_->release(hip, 0);
  base.flags |= kNotBuilt;
  return keep(base, Place::kOnBase);
}

// The base polygons tell where patches matter, and catch what passes through them in a tick.
Contact LazyContact::tick_free(const Vec3& hip, double dt) noexcept {
  const Contact base = base_.tick(hip, dt);
  if (!base.touching && base.distance > mesh_->reach()) {
    clear_ = base.distance - mesh_->reach();
    if (patches_) patches_->release(hip, clear_);
    return base;
  }
  if (covers(base.at.face)) {
    const Contact contact = patches_->tick(hip, dt);
    if (holds(contact)) return keep(contact, Place::kOnPatches);
  }
  return stand_in(hip, base);
}

Contact LazyContact::tick_on_patches(const Vec3& hip, double dt) noexcept {
  const Settling felt = patches_->felt();
  const Contact contact = patches_->tick(hip, dt);
  if (!holds(contact))
    return stand_in(hip, base_.track(hip, {face_}, &felt, &patches_->friction(), dt));
  if (!contact.touching) base_.release(hip, 0);
  return keep(contact, Place::kOnPatches);
}

Contact LazyContact::tick_on_base(const Vec3& hip, double dt) noexcept {
  const Settling felt = base_.felt();
  const Contact base = base_.tick(hip, dt);
  if (covers(base.at.face)) {
    const Contact contact = patches_->track(hip, base.at, &felt, &base_.friction(), dt);
    if (holds(contact)) return keep(contact, Place::kOnPatches);
  }
  return stand_in(hip, base);
}

}  // namespace gliss
