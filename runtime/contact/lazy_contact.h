// One HIP on a mesh whose patches a worker builds ahead of it: ContactTracker for a device, where a
// tick never waits. Where the worker is late, the base polygons stand in, on the side that the
// contact is on, and the contact says so (kNotBuilt).
#pragma once

#include <optional>

#include "gliss/base/export.h"
#include "gliss/contact/lazy_worker.h"
#include "gliss/query/contact_tracker.h"

namespace gliss {

// One thread's at a time, and its worker's. It keeps the mesh alive. HIPs and contacts are in the
// mesh's unit.
class GLISS_EXPORT LazyContact {
 public:
  // query.method: kGregory.
  LazyContact(std::shared_ptr<const LazyMesh> mesh, const QueryOptions& query,
              LazyWorkerOptions options = {});

  // Every HIP, also where it is clear: the worker goes by them.
  void post(const Vec3& hip) noexcept { worker_.post(hip, touching(), face_); }
  // As ContactTracker's.
  Contact tick(const Vec3& hip, double dt = ContactTracker::kTick) noexcept;
  bool set_friction(const FrictionOptions& friction) noexcept;
  bool touching() const { return place_ != Place::kFree; }
  bool is_clear(const Vec3& hip) const { return !touching() && (hip - last_).norm() < clear_; }
  const LazyWorker& worker() const { return worker_; }
  // The tracker that gave the last contact.
  const ContactTracker& tracker() const { return place_ == Place::kOnPatches ? *patches_ : base_; }

 private:
  enum class Place { kFree, kOnPatches, kOnBase };

  void take_region() noexcept;
  Contact tick_free(const Vec3& hip, double dt) noexcept;
  Contact tick_on_patches(const Vec3& hip, double dt) noexcept;
  Contact tick_on_base(const Vec3& hip, double dt) noexcept;
  Contact keep(const Contact& contact, Place touched) noexcept;
  Contact stand_in(const Vec3& hip, Contact base) noexcept;
  bool covers(std::uint32_t face) const { return region_ != nullptr && region_->covers(face); }
  bool holds(const Contact& contact) const;

  const std::shared_ptr<const LazyMesh> mesh_;
  LazyWorker worker_;
  const LazyRegion *region_ = nullptr, *next_ = nullptr;  // next_ waits until the contact is there
  QueryOptions query_;
  std::optional<ContactTracker> patches_;  // on region_
  ContactTracker base_;
  Place place_ = Place::kFree;
  std::uint32_t face_ = 0;    // of the last contact
  Vec3 last_ = Vec3::Zero();  // the last HIP
  double clear_ = -1;         // no surface is nearer to it than this
};

}  // namespace gliss
