#include "gliss/query/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gliss {
template <class Real>
Eigen::Vector2d domain_corner(const Surface<Real>& s, std::uint32_t n, std::uint32_t k) {
  const Real* c = &s.domain[s.domain_begin[n] + kDomainHead + kDomainStride * k + kDomainCorner];
  return {static_cast<double>(c[0]), static_cast<double>(c[1])};
}

namespace {

// True if the patch is one triangle of its face rather than all of it.
bool is_part(const PatchCache& cache, std::uint32_t patch) {
  const std::uint32_t face = cache.patch_face[patch], next = patch + 1;
  return cache.face_patch[face] != patch ||
         (next < cache.patch_count() && cache.patch_face[next] == face);
}

// The corners of a part in the domain of its face, and in its own.
template <class Real>
struct PartDomain {
  Eigen::Matrix3d in_face, in_patch;  // columns: corners, homogeneous
  PartDomain(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch) {
    const std::uint32_t n = cache.face_valence[cache.patch_face[patch]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = cache.corner_of_face[s.side_begin[patch] + k];
      in_face.col(k) << (corner < n ? domain_corner(s, n, corner) : Eigen::Vector2d(0, 0)), 1.0;
      in_patch.col(k) << domain_corner(s, 3, k), 1.0;
    }
  }
};

template <class Real>
DomainPoint face_point(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch,
                       double xi, double eta) {
  DomainPoint point{cache.patch_face[patch], xi, eta};
  if (!is_part(cache, patch)) return point;
  const PartDomain<Real> part(cache, s, patch);
  const Vec3 at = part.in_face * part.in_patch.inverse() * Vec3(xi, eta, 1);
  point.xi = at.x();
  point.eta = at.y();
  return point;
}

template <class Real>
Vec3 from_local(const PatchCache& cache, const Surface<Real>& s, std::uint32_t patch,
                const Vec3& local) {
  const Real* numbers = &s.patch[patch * kPatchReals];
  const Vec3 origin(numbers[kPatchOrigin], numbers[kPatchOrigin + 1], numbers[kPatchOrigin + 2]);
  return cache.origin +
         (origin + local * static_cast<double>(numbers[kPatchUnscale])) * (1 / cache.scale);
}

// The sign of a NaN is a matter of compilers: one for all.
template <class Real>
double number(Real x) {
  return std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(x);
}
template <class Real>
Vec3 vec(const Real* v) {
  return {number(v[0]), number(v[1]), number(v[2])};
}

}  // namespace

template <class Real>
PatchPlace place_of(const PatchCache& cache, const Surface<Real>& s, const DomainPoint& point) {
  PatchPlace place;
  place.patch = cache.face_patch[point.face];
  place.xi = point.xi;
  place.eta = point.eta;
  if (!is_part(cache, place.patch)) return place;
  double best = -1;
  const std::uint32_t first = place.patch;
  for (std::uint32_t p = first; p < cache.patch_count() && cache.patch_face[p] == point.face; ++p) {
    const PartDomain<Real> part(cache, s, p);
    const Vec3 at = part.in_face.inverse() * Vec3(point.xi, point.eta, 1);
    if (at.minCoeff() <= best && p != first) continue;
    best = at.minCoeff();
    const Vec3 own = part.in_patch * at;
    place = {p, own.x(), own.y()};
  }
  return place;
}

template <class Real>
void surface_points(const PatchCache& cache, const Surface<Real>& s,
                    std::span<const std::uint32_t> patch, std::span<const std::uint32_t> slot,
                    const Real* rows, std::size_t stride, std::span<SurfacePoint> out) {
  const double inverse = 1 / cache.scale;
  std::uint32_t last = kNone;
  Vec3 origin = Vec3::Zero(), upward = Vec3::UnitZ();
  double unscale = 1;
  std::optional<Eigen::Matrix2d> map;  // d(patch xi, eta) / d(face xi, eta), of a part
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (patch[i] != last) {
      last = patch[i];
      const Real* numbers = &s.patch[last * kPatchReals];
      origin = vec(numbers + kPatchOrigin);
      upward = vec(numbers + kPatchNormal).normalized();
      unscale = static_cast<double>(numbers[kPatchUnscale]);
      map.reset();
      if (is_part(cache, last)) {
        const PartDomain<Real> part(cache, s, last);
        map = (part.in_patch * part.in_face.inverse()).template topLeftCorner<2, 2>();
      }
    }
    const Real* column = rows + slot[i];
    const auto triple = [&](std::size_t r) {
      return Vec3(column[r * stride], column[(r + 1) * stride], column[(r + 2) * stride]);
    };
    const Vec3 g_xi = triple(3), g_eta = triple(6);
    SurfacePoint& p = out[i];
    p.position = cache.origin + (origin + triple(0) * unscale) * inverse;
    p.d_xi = g_xi * (unscale * inverse);
    p.d_eta = g_eta * (unscale * inverse);
    const Vec3 across = g_xi.cross(g_eta);
    const bool spans =
        spans_a_plane(across.norm(), std::max(g_xi.squaredNorm(), g_eta.squaredNorm()),
                      static_cast<double>(std::numeric_limits<Real>::epsilon()));
    p.normal = spans ? Vec3(across.normalized()) : upward;
    if (map) {
      const Eigen::Matrix<double, 3, 2> d =
          (Eigen::Matrix<double, 3, 2>() << p.d_xi, p.d_eta).finished() * *map;
      p.d_xi = d.col(0);
      p.d_eta = d.col(1);
    }
  }
}

template <class Real>
RawHip<Real> raw_hip(const PatchCache& cache, const Vec3& hip) {
  RawHip<Real> raw;
  for (int i = 0; i < 3; ++i) {
    const double x = (hip[i] - cache.origin[i]) * cache.scale;
    raw.parts[i] = static_cast<Real>(x);
    raw.parts[i + 3] = static_cast<Real>(x - static_cast<double>(raw.parts[i]));
  }
  return raw;
}

template <class Real>
TrackOptions<Real> track_options(const QueryOptions& options) {
  double tolerance = options.tolerance;
  // The paper's solver ends by the residual angle: its threshold of 1e-5.
  if (tolerance == 0)
    tolerance = options.solver == Solver::kPaper ? 1e-5 : sizeof(Real) == 4 ? 0x1p-18 : 0x1p-36;
  return {options.solver, options.max_iterations, static_cast<Real>(tolerance), options.budget};
}

template <class Real>
Contact contact_of(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw) {
  const std::uint32_t patch = raw.uints[kContactPatch];
  Contact c;
  c.touching = raw.uints[kContactState] != 0;
  c.at = face_point(cache, s, patch, number(raw.reals[kContactXi]), number(raw.reals[kContactEta]));
  c.scp = from_local(cache, s, patch, vec(raw.reals + kContactScp));
  c.normal = vec(raw.reals + kContactNormal);
  const Vec3 offset = vec(raw.reals + kContactOffset) / cache.scale;
  c.distance = (c.touching ? -1 : 1) * offset.norm();
  const Vec3 push = vec(raw.reals + kContactPush) / cache.scale;
  c.push = c.touching || push.hasNaN() ? push : Vec3(Vec3::Zero());
  c.residual_angle = std::atan2(offset.cross(c.normal).norm(), std::abs(offset.dot(c.normal)));
  c.iterations = static_cast<int>(raw.uints[kContactIterations]);
  c.crossings = static_cast<int>(raw.uints[kContactCrossings]);
  c.flags = raw.uints[kContactFlags];
  c.clear = number(raw.reals[kContactClear]) / cache.scale;
  return c;
}

#define GLISS_FRAMES(REAL)                                                                     \
  template Eigen::Vector2d domain_corner(const Surface<REAL>&, std::uint32_t, std::uint32_t);  \
  template PatchPlace place_of(const PatchCache&, const Surface<REAL>&, const DomainPoint&);   \
  template void surface_points(const PatchCache&, const Surface<REAL>&,                        \
                               std::span<const std::uint32_t>, std::span<const std::uint32_t>, \
                               const REAL*, std::size_t, std::span<SurfacePoint>);             \
  template RawHip<REAL> raw_hip(const PatchCache&, const Vec3&);                               \
  template TrackOptions<REAL> track_options(const QueryOptions&);                              \
  template Contact contact_of(const PatchCache&, const Surface<REAL>&, const RawContact<REAL>&);
GLISS_FRAMES(float)
GLISS_FRAMES(double)

}  // namespace gliss
