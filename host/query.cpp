#include "host/query.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gliss {
namespace {

// A point of a patch's own domain, and the affine map of the face's domain to it: d(patch xi, eta)
// / d(face xi, eta).
struct PatchPlace {
  std::uint32_t patch = 0;
  double xi = 0, eta = 0;
  Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity();
};

using Vec2 = Eigen::Vector2d;

template <class Real>
Vec2 domain_corner(const Surface<Real>& s, std::uint32_t n, std::uint32_t k) {
  const Real* c = &s.domain[s.domain_begin[n] + 2 + 6 * k + 4];
  return {static_cast<double>(c[0]), static_cast<double>(c[1])};
}

// Whether the patch is one triangle of its face rather than all of it.
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
      in_face.col(k) << (corner < n ? domain_corner(s, n, corner) : Vec2(0, 0)), 1.0;
      in_patch.col(k) << domain_corner(s, 3, k), 1.0;
    }
  }
};

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
    const Eigen::Matrix3d inverse = part.in_face.inverse();
    const Vec3 at = inverse * Vec3(point.xi, point.eta, 1);
    if (at.minCoeff() <= best && p != first) continue;
    best = at.minCoeff();
    const Vec3 own = part.in_patch * at;
    place = {p, own.x(), own.y(), (part.in_patch * inverse).template topLeftCorner<2, 2>()};
  }
  return place;
}

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
         (origin + local * static_cast<double>(numbers[kPatchUnscale])) / cache.scale;
}

template <class Real>
Vec3 vec(const Real* v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

template <class Real>
RawHip<Real> raw_hip(const PatchCache& cache, const Vec3& hip) {
  RawHip<Real> raw;
  for (int i = 0; i < 3; ++i) {
    const double x = (hip[i] - cache.origin[i]) * cache.scale;
    raw.high[i] = static_cast<Real>(x);
    raw.low[i] = static_cast<Real>(x - static_cast<double>(raw.high[i]));
  }
  return raw;
}

template <class Real>
TrackOptions<Real> track_options(const QueryOptions& options) {
  double tolerance = options.tolerance;
  // The paper's solver ends by the residual angle: its threshold of 1e-5.
  if (tolerance == 0)
    tolerance = options.solver == Solver::kPaper ? 1e-5 : sizeof(Real) == 4 ? 0x1p-18 : 0x1p-36;
  return {options.solver, options.max_iterations, static_cast<Real>(tolerance)};
}

template <class Real>
Contact contact_of(const PatchCache& cache, const Surface<Real>& s, const RawContact<Real>& raw) {
  Contact c;
  c.touching = raw.touching;
  c.at = face_point(cache, s, raw.patch, static_cast<double>(raw.xi), static_cast<double>(raw.eta));
  c.scp = from_local(cache, s, raw.patch, vec(raw.scp));
  c.normal = vec(raw.normal);
  const Vec3 offset = vec(raw.offset) / cache.scale;
  c.distance = (raw.touching ? -1 : 1) * offset.norm();
  c.push = raw.touching ? Vec3(vec(raw.push) / cache.scale) : Vec3(Vec3::Zero());
  c.residual_angle = std::atan2(offset.cross(c.normal).norm(), std::abs(offset.dot(c.normal)));
  c.iterations = raw.iterations;
  c.crossings = raw.crossings;
  c.flags = raw.flags;
  return c;
}

template <class Real>
void evaluate_points(const PatchCache& cache, const Surface<Real>& s, std::uint32_t face,
                     std::span<const double> xi, std::span<const double> eta,
                     std::span<SurfacePoint> out) {
  constexpr std::size_t kBlock = 64;
  Real x[kBlock], y[kBlock], rows[9 * kBlock];
  std::size_t done = 0;
  while (done < xi.size()) {
    // As many points as lie in the same patch of the face.
    const PatchPlace first = place_of(cache, s, {face, xi[done], eta[done]});
    std::size_t count = 0;
    for (PatchPlace at = first; at.patch == first.patch;) {
      x[count] = static_cast<Real>(at.xi);
      y[count++] = static_cast<Real>(at.eta);
      if (count == kBlock || done + count == xi.size()) break;
      at = place_of(cache, s, {face, xi[done + count], eta[done + count]});
    }
    const std::uint32_t n = s.valence(first.patch);
    kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                             &s.control[s.side_begin[first.patch] * kSideReals], n, x, y, count,
                             kBlock, rows);
    const double unscale =
        static_cast<double>(s.patch[first.patch * kPatchReals + kPatchUnscale]) / cache.scale;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = [&](std::size_t r) {
        return Vec3(rows[r * kBlock + i], rows[(r + 1) * kBlock + i], rows[(r + 2) * kBlock + i]);
      };
      const Vec3 dx = row(3) * unscale, dy = row(6) * unscale;
      SurfacePoint& p = out[done + i];
      p.position = from_local(cache, s, first.patch, row(0));
      p.d_xi = first.jacobian(0, 0) * dx + first.jacobian(1, 0) * dy;
      p.d_eta = first.jacobian(0, 1) * dx + first.jacobian(1, 1) * dy;
      p.normal = row(3).cross(row(6)).normalized();
    }
    done += count;
  }
}

// Calls f with the surface in its own precision.
template <class F>
auto with_surface(const PatchCache& cache, F f) {
  return cache.surface.index() == 0 ? f(std::get<0>(cache.surface)) : f(std::get<1>(cache.surface));
}

}  // namespace

bool in_domain(const PatchCache& cache, const DomainPoint& point) {
  if (point.face >= cache.mesh_face_count || cache.face_patch[point.face] == kNone) return false;
  return with_surface(cache, [&](const auto& s) {
    const std::uint32_t n = cache.face_valence[point.face];
    for (std::uint32_t k = 0; k < n; ++k) {
      const Vec2 a = domain_corner(s, n, k), b = domain_corner(s, n, (k + 1) % n),
                 x(point.xi, point.eta);
      const double area = (b - a).x() * (x - a).y() - (b - a).y() * (x - a).x();
      if (!(area >= -1e-6 * (b - a).norm())) return false;
    }
    return true;
  });
}

SurfacePoint evaluate(const PatchCache& cache, const DomainPoint& point) {
  SurfacePoint p;
  evaluate(cache, point.face, {&point.xi, 1}, {&point.eta, 1}, {&p, 1});
  return p;
}

void evaluate(const PatchCache& cache, std::uint32_t face, std::span<const double> xi,
              std::span<const double> eta, std::span<SurfacePoint> out) {
  with_surface(cache, [&](const auto& s) { evaluate_points(cache, s, face, xi, eta, out); });
}

Contact nearest(const PatchCache& cache, const Vec3& hip, const QueryOptions& options) {
  Contact contact;
  nearest(cache, hip, {&options.method, 1}, options, {&contact, 1});
  return contact;
}

void nearest(const PatchCache& cache, const Vec3& hip, std::span<const Method> methods,
             const QueryOptions& options, std::span<Contact> out) {
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    std::array<RawContact<Real>, kMethods> raw;
    kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options),
                            raw_hip<Real>(cache, hip), raw.data());
    for (std::size_t i = 0; i < methods.size(); ++i) out[i] = contact_of(cache, s, raw[i]);
  });
}

ContactTracker::ContactTracker(const PatchCache& cache, const QueryOptions& options)
    : cache_(cache), options_(options) {
  if (cache.surface.index() == 1) state_.emplace<1>();
}

Contact ContactTracker::tick(const Vec3& hip) noexcept {
  return with_surface(cache_, [&]<class Real>(const Surface<Real>& s) {
    RawContact<Real>& state = *std::get_if<RawContact<Real>>(&state_);
    kernels<Real>().tick(s, options_.method, track_options<Real>(options_),
                         raw_hip<Real>(cache_, hip), &state);
    return contact_of(cache_, s, state);
  });
}

Contact ContactTracker::track(const Vec3& hip, const DomainPoint& start) noexcept {
  return with_surface(cache_, [&]<class Real>(const Surface<Real>& s) {
    RawContact<Real>& state = *std::get_if<RawContact<Real>>(&state_);
    const PatchPlace place = place_of(cache_, s, start);
    state.patch = place.patch;
    state.xi = static_cast<Real>(place.xi);
    state.eta = static_cast<Real>(place.eta);
    kernels<Real>().track(s, options_.method, track_options<Real>(options_),
                          raw_hip<Real>(cache_, hip), &state);
    return contact_of(cache_, s, state);
  });
}

bool ContactTracker::touching() const {
  return std::visit([](const auto& state) { return state.touching; }, state_);
}

}  // namespace gliss
