// Questions to a patch cache, in the mesh's unit and double whatever its precision: points of a
// face's patch, the nearest point of the surface, and the tick that follows a contact. What takes
// one point allocates nothing, and nothing checks its input again.
#pragma once

#include <cstdint>
#include <span>

#include "host/kernels.h"
#include "host/patch_cache.h"

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

// At t, 0 to 1, along side k, from corner k to the next, of a face of n sides.
DomainPoint on_side(std::uint32_t face, std::uint32_t n, std::uint32_t k, double t);
// Whether a point lies in the domain of a face that has a patch.
bool in_domain(const PatchCache& cache, const DomainPoint& point);
SurfacePoint evaluate(const PatchCache& cache, const DomainPoint& point);
// Many points of any faces: as evaluate, several lanes at a time; allocates.
void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
              std::span<SurfacePoint> out);

// How far a solver goes on: until its step is shorter than `tolerance`, relative to the size of the
// patch, or as often as is allowed.
struct SolverOptions {
  Solver solver = Solver::kNewton;
  int max_iterations = 64;
  double tolerance = 0;  // 0: as exact as the precision allows; of kPaper a residual angle, rad
};

struct QueryOptions : SolverOptions {
  Method method = Method::kGregory;
};

struct Contact {
  bool touching = false;  // the HIP is inside
  DomainPoint at;         // of the SCP
  Vec3 scp = Vec3::Zero(),
       normal = Vec3::Zero();  // surface contact point, mesh's unit; outward unit normal
  double distance = 0;         // signed, mesh's unit; negative inside
  Vec3 push = Vec3::Zero();    // SCP - HIP for gregory and flat, turned to the normal for shaded;
                               // zero outside. Mesh's unit
  double residual_angle = 0;   // between SCP - HIP and the normal, rad
  int iterations = 0, crossings = 0;  // iterations: over all patches that were tried
  std::uint32_t flags = 0;            // kConverged, kOnBorder, kOnCrease, kNotBuilt
};

// Global: the nearest point of the surface.
Contact nearest(const PatchCache& cache, const Vec3& hip, const QueryOptions& options = {});

// The same for several methods (at most kMethods, each once; options.method is not read), which
// share the search.
void nearest(const PatchCache& cache, const Vec3& hip, std::span<const Method> methods,
             const QueryOptions& options, std::span<Contact> out);
// Of many HIPs, several lanes at a time: HIP i with method m at out[m * stride + i]. Allocates.
void nearest(const PatchCache& cache, std::span<const Vec3> hips, std::span<const Method> methods,
             const QueryOptions& options, std::size_t stride, Contact* out);

// Local: the nearest point that each HIP slides to from its start, several lanes at a time.
// Allocates.
void track(const PatchCache& cache, std::span<const Vec3> hips, std::span<const DomainPoint> starts,
           const QueryOptions& options, std::span<Contact> out);

// Algorithm 1 for one HIP: a search while free, local tracking in contact, so that it stays on the
// side that it came in by, however deep and thin the part. Between two ticks a free HIP moves along
// a line; where that meets the surface, contact begins there, so that no speed tunnels through a
// plate. One object per HIP, cache and method.
class ContactTracker {
 public:
  // Of the solver, after which a tick that follows a far jump begins no further search: it has no
  // contact, and the next one goes on along the line. Some milliseconds' worth; the default solver
  // needs less for a hand at 2 m/s (5,907 at worst, on a fin).
  static constexpr int kSweepIterations = 8192;

  ContactTracker(const PatchCache& cache, const QueryOptions& options);
  Contact tick(const Vec3& hip) noexcept;
  // As tick, from a given contact, whatever the state: the local nearest point.
  Contact track(const Vec3& hip, const DomainPoint& start) noexcept;
  bool touching() const;
  // Free from here on, where no surface is nearer than `clear`.
  void release(const Vec3& hip, double clear) noexcept;
  // Goes on with another cache of the same mesh and precision; in contact, one that has the patch
  // that is touched.
  void move_to(const PatchCache& cache) noexcept;
  // Free, and nearer to the last HIP than any surface: a tick would find no contact.
  bool is_clear(const Vec3& hip) const { return (hip - last_).norm() < clear_; }

 private:
  template <class Real>
  bool meet(const Surface<Real>& s, const Vec3& hip, RawContact<Real>& state, int& iterations);

  const PatchCache* cache_;
  QueryOptions options_;
  std::variant<RawContact<float>, RawContact<double>> state_;
  Vec3 last_ = Vec3::Zero();  // a HIP of a tick before, or where its sweep has come
  double clear_ = -1;         // no surface is nearer to it than this; negative: there was no tick
};

// F = stiffness (N/m) x push, in newtons.
inline Vec3 force(const PatchCache& cache, const Contact& contact, double stiffness) {
  return stiffness * cache.unit * contact.push;
}

}  // namespace gliss
