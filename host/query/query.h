// Questions to a patch cache, in the mesh's unit and double whatever its precision: points of a
// face's patch and the nearest point of the surface. What takes one point allocates nothing. A
// DomainPoint must be in_domain; nothing checks that again.
//
// All throw std::invalid_argument for a cache without patches, such as one that was moved from, and
// for results that have less room than there are questions. The thread's rounding mode changes
// nothing.
//
// Any number of threads may ask one const PatchCache at once. Calls for many points keep their
// working arrays for the next call, one set a thread, as large as its largest batch.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "gliss/base/export.h"
#include "gliss/surface/arrays.h"
#include "gliss/surface/contact.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// A point of a face's patch: (xi, eta) lies in the regular n-gon with corners (cos 2 k pi / n, sin
// 2 k pi / n).
struct DomainPoint {
  std::uint32_t face = 0;
  double xi = 0, eta = 0;
};

struct SurfacePoint {
  Vec3 position, d_xi, d_eta;  // G and its derivatives (eq. 4), mesh's unit
  Vec3 normal;  // outward, unit; that of the polygon where the derivatives span no plane
};

// Throws std::invalid_argument unless there is room for as many as are needed.
GLISS_EXPORT void require_room(std::size_t room, std::size_t needed);

// At t, 0 to 1, along side k, from corner k to the next, of a face of n sides.
GLISS_EXPORT DomainPoint on_side(std::uint32_t face, std::uint32_t n, std::uint32_t k, double t);
// True if a point lies in the domain of a face that has a patch.
GLISS_EXPORT bool in_domain(const PatchCache& cache, const DomainPoint& point);
GLISS_EXPORT SurfacePoint evaluate(const PatchCache& cache, const DomainPoint& point);
// Many points of any faces, several lanes at a time: point i at out[i]. Those of one face in a row
// are fastest. Allocates.
GLISS_EXPORT void evaluate(const PatchCache& cache, const PointArrays<double>& points,
                           const SurfaceArrays<double>& out);
GLISS_EXPORT void evaluate(const PatchCache& cache, const PointArrays<float>& points,
                           const SurfaceArrays<float>& out);
GLISS_EXPORT void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
                           std::span<SurfacePoint> out);
// The same points (xi, eta) on each of the faces: point j of face i at out[i * points + j].
// Allocates. Throws std::invalid_argument unless there are as many eta as xi.
GLISS_EXPORT void evaluate_grid(const PatchCache& cache, std::span<const std::uint32_t> faces,
                                std::span<const double> xi, std::span<const double> eta,
                                const SurfaceArrays<double>& out);
GLISS_EXPORT void evaluate_grid(const PatchCache& cache, std::span<const std::uint32_t> faces,
                                std::span<const float> xi, std::span<const float> eta,
                                const SurfaceArrays<float>& out);

// Says when a solver ends: where its step is shorter than `tolerance`, relative to the size of the
// patch, or after as many steps as are allowed.
struct SolverOptions {
  Solver solver = Solver::kNewton;
  int max_iterations = 64;
  double tolerance = 0;  // 0: as exact as the precision allows; of kPaper a residual angle, rad
};

// s: the default of QueryOptions::settle, and the most that it and FrictionOptions::settle may be.
constexpr double kSettleTime = 5e-3, kMostSettleTime = 1;

// Coulomb's law: how large the tangential part of a contact's force may be, over the normal part,
// before the contact point slips, and while it does (Friction). Both 0: it slides freely. For
// ContactTracker alone: what has no time has no friction.
struct FrictionOptions {
  static constexpr double kMost = 5;
  double at_rest = 0, slipping = 0;  // 0 to kMost, slipping at most at_rest
  // s, in which the one goes to the other by 1 - 1/e once the point slips; 0: at once.
  double settle = 0;

  bool any() const { return at_rest > 0; }
};

struct QueryOptions : SolverOptions {
  Method method = Method::kGregory;
  // Evaluations after which a search begins no further descent, so that it spends at most
  // max_iterations + 1 more; 0: no limit. A search that ends so has kUnfinished. Usual meshes take
  // up to ten thousand, and that where a HIP is as near to many places; the default is a bound for
  // those made to take more.
  int budget = 1 << 16;
  // For ContactTracker alone. Where the nearest point leaps, the contact slides there instead. This
  // is the time (s) in which the force changes by 20 % of itself meanwhile. 0: it leaps, as in the
  // paper.
  double settle = kSettleTime;
  FrictionOptions friction = {};
};

struct Contact {
  bool touching = false;  // the HIP is inside
  DomainPoint at;         // of the SCP
  Vec3 scp = Vec3::Zero(),
       normal = Vec3::Zero();  // surface contact point, mesh's unit; outward unit normal
  double distance = 0;         // signed, mesh's unit; negative inside
  // SCP - HIP for gregory and flat, its normal part turned for shaded; zero outside. NaN where the
  // surface is at fault: its numbers give no contact, though the HIP is near. Mesh's unit
  Vec3 push = Vec3::Zero();
  double residual_angle = 0;          // between SCP - HIP and the normal, rad
  int iterations = 0, crossings = 0;  // iterations: over all patches that were tried
  // kConverged, kOnBorder, kOnCrease, kNotBuilt, kUnfinished, kSettling, kSlipping
  std::uint32_t flags = 0;
  // The distance that a search found no surface nearer than, but for rounding, mesh's unit:
  // |distance| unless it is kUnfinished. Tracking leaves 0.
  double clear = 0;
};

// Global: the nearest point of the surface.
GLISS_EXPORT Contact nearest(const PatchCache& cache, const Vec3& hip,
                             const QueryOptions& options = {});

// The same for several methods (at most kMethods, or std::invalid_argument; each once;
// options.method is not read), which share the search.
GLISS_EXPORT void nearest(const PatchCache& cache, const Vec3& hip, std::span<const Method> methods,
                          const QueryOptions& options, std::span<Contact> out);
// The nearest points of many HIPs, several lanes at a time: HIP i with method m at out[m][i].
// Allocates.
GLISS_EXPORT void nearest(const PatchCache& cache, const HipArrays<double>& hips,
                          std::span<const Method> methods, const QueryOptions& options,
                          std::span<const ContactArrays<double>> out);
GLISS_EXPORT void nearest(const PatchCache& cache, const HipArrays<float>& hips,
                          std::span<const Method> methods, const QueryOptions& options,
                          std::span<const ContactArrays<float>> out);
// The same at out[m * hips + i].
GLISS_EXPORT void nearest(const PatchCache& cache, std::span<const Vec3> hips,
                          std::span<const Method> methods, const QueryOptions& options,
                          std::span<Contact> out);

// Local: the nearest point that each HIP slides to from its start, several lanes at a time.
// Allocates.
GLISS_EXPORT void track(const PatchCache& cache, const HipArrays<double>& hips,
                        const PointArrays<double>& starts, const QueryOptions& options,
                        const ContactArrays<double>& out);
GLISS_EXPORT void track(const PatchCache& cache, const HipArrays<float>& hips,
                        const PointArrays<float>& starts, const QueryOptions& options,
                        const ContactArrays<float>& out);
GLISS_EXPORT void track(const PatchCache& cache, std::span<const Vec3> hips,
                        std::span<const DomainPoint> starts, const QueryOptions& options,
                        std::span<Contact> out);

// Structs as arrays, of as many as the span holds.
GLISS_EXPORT PointArrays<double> arrays_of(std::span<const DomainPoint> points);
GLISS_EXPORT SurfaceArrays<double> arrays_of(std::span<SurfacePoint> points);
GLISS_EXPORT HipArrays<double> arrays_of(std::span<const Vec3> hips);
GLISS_EXPORT ContactArrays<double> arrays_of(std::span<Contact> contacts);
// [method][hip] as arrays of each method.
GLISS_EXPORT std::array<ContactArrays<double>, kMethods> by_method(std::span<Contact> contacts,
                                                                   std::size_t hips,
                                                                   std::size_t methods);

// True if a spring may have it (N/m): it is 0 or more, and finite.
inline bool is_stiffness(double x) { return x >= 0 && std::isfinite(x); }

// F = stiffness (N/m) x push (mesh's unit), in newtons.
inline Vec3 push_force(const PatchCache& cache, const Vec3& push, double stiffness) {
  return stiffness * cache.unit * push;
}
inline Vec3 contact_force(const PatchCache& cache, const Contact& contact, double stiffness) {
  return push_force(cache, contact.push, stiffness);
}

}  // namespace gliss
