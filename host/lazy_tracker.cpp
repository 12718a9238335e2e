#include "host/lazy_tracker.h"

namespace gliss {
namespace {

Mesh with_normals(Mesh mesh) {
  add_vertex_normals(mesh);
  return mesh;
}

}  // namespace

LazyTracker::LazyTracker(Mesh mesh, const LazyOptions& options)
    : mesh_(with_normals(std::move(mesh))),
      topology_(build_topology(mesh_)),
      options_(options),
      base_(build_base(mesh_, topology_, options.precision)) {}

void LazyTracker::build_around(std::uint32_t face) {
  BuildOptions build;
  build.precision = options_.precision;
  build.faces = faces_around(mesh_, topology_, face, options_.rings);
  tracker_.reset();
  region_ = std::make_unique<PatchCache>(build_cache(mesh_, topology_, build));
  tracker_ = std::make_unique<ContactTracker>(*region_, options_.query);
  built_ += region_->patch_count();
}

// Whether a neighbour of the face is not built though the mesh has it.
bool LazyTracker::near_rim(std::uint32_t face) const {
  for (std::uint32_t s = mesh_.face_begin[face]; s < mesh_.face_begin[face + 1]; ++s) {
    const std::uint32_t twin = topology_.side_twin[s];
    if (twin != kNone && region_->face_patch[topology_.side_face[twin]] == kNone) return true;
  }
  return false;
}

std::uint32_t LazyTracker::nearest_face(const Vec3& hip) const {
  QueryOptions flat;
  flat.method = Method::kFlat;
  return nearest(base_, hip, flat).at.face;
}

Contact LazyTracker::tick(const Vec3& hip) {
  const bool touching = tracker_ != nullptr && tracker_->touching();
  if (!touching) {
    const std::uint32_t face = nearest_face(hip);
    if (region_ == nullptr || region_->face_patch[face] == kNone || near_rim(face))
      build_around(face);
  }
  Contact contact = tracker_->tick(hip);
  // At the rim the surface goes on where the region does not: build there and follow on.
  for (std::uint32_t last = kNone; near_rim(contact.at.face) && contact.at.face != last;) {
    last = contact.at.face;
    build_around(last);
    contact = tracker_->track(hip, contact.at);
  }
  return contact;
}

}  // namespace gliss
