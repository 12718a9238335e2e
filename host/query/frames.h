// Between the mesh's unit and double on one side, and the frames and precision of the kernels on
// the other (kernels/view.h).
#pragma once

#include "gliss/base/export.h"
#include "gliss/query/query.h"
#include "gliss/surface/layout.h"

namespace gliss {

// A point of a patch's own domain.
struct PatchPlace {
  std::uint32_t patch = 0;
  double xi = 0, eta = 0;
};

template <class Real>
GLISS_EXPORT PatchPlace place_of(const PatchCache& cache, const Surface<Real>& s,
                                 const DomainPoint& point);

// True if the patch is one triangle of its face rather than all of it.
GLISS_EXPORT bool is_piece_of_face(const PatchCache& cache, std::uint32_t patch);

// Places points as Kernels::place_double does, with derivatives by the coordinates of the face
// where a patch is but a part of it.
template <class Real, class T>
GLISS_EXPORT void place_points(const PatchCache& cache, const Surface<Real>& s,
                               const EvaluatedPoints<Real>& points, const SurfaceArrays<T>& out,
                               const Kernels<Real>& by = kernels<Real>());

template <class T>
Vec3 hip_at(const HipArrays<T>& hips, std::size_t i) {
  const StridedVectors<const T>& at = hips.position;
  return {static_cast<double>(at.x[i]), static_cast<double>(at.y[i]), static_cast<double>(at.z[i])};
}
template <class T>
DomainPoint point_at(const PointArrays<T>& points, std::size_t i) {
  return {points.face[i], static_cast<double>(points.xi[i]), static_cast<double>(points.eta[i])};
}

template <class Real>
GLISS_EXPORT RawHip<Real> raw_hip(const PatchCache& cache, const Vec3& hip);

// Gives the result of a search the state that the winding number says: of polygons that fold, by
// gregory where the HIP lies between no patch and its polygon.
template <class Real>
GLISS_EXPORT void correct_state(const PatchCache& cache, Method method, const RawHip<Real>& hip,
                                RawContact<Real>& raw);

template <class Real>
GLISS_EXPORT TrackOptions<Real> track_options(const QueryOptions& options);

template <class Real>
GLISS_EXPORT Contact contact_of(const PatchCache& cache, const Surface<Real>& s,
                                const RawContact<Real>& raw);

// The same to the i-th of arrays.
template <class Real, class T>
GLISS_EXPORT void store_contact(const PatchCache& cache, const Surface<Real>& s,
                                const RawContact<Real>& raw, const ContactArrays<T>& out,
                                std::size_t i);

// Makes a state of a point from which to track.
template <class Real>
void place_at(const PatchPlace& place, RawContact<Real>& state) {
  state.uints[kContactPatch] = place.patch;
  state.held_count = 0;
  state.reals[kContactXi] = static_cast<Real>(place.xi);
  state.reals[kContactEta] = static_cast<Real>(place.eta);
}

// Corner k of the domain of a valence in use.
template <class Real>
GLISS_EXPORT Eigen::Vector2d domain_corner(const Surface<Real>& s, std::uint32_t n,
                                           std::uint32_t k);

// Calls f with the surface in its own precision.
template <class F>
auto with_surface(const PatchCache& cache, F f) {
  return cache.surface.index() == 0 ? f(std::get<0>(cache.surface)) : f(std::get<1>(cache.surface));
}

}  // namespace gliss
