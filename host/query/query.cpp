#include "gliss/query/query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/build/patch_batch.h"
#include "gliss/query/frames.h"
#include "gliss/query/point_blocks.h"

namespace gliss {
namespace {

template <class Real>
const Real* control_of(const Surface<Real>& s, std::uint32_t patch) {
  return &s.control[3 * std::size_t{s.control_begin[patch]}];
}

template <class Real>
SurfacePoint evaluate_point(const PatchCache& cache, const Surface<Real>& s,
                            const DomainPoint& at) {
  const PatchPlace place = place_of(cache, s, at);
  const auto xi = static_cast<Real>(place.xi), eta = static_cast<Real>(place.eta);
  const std::uint32_t n = s.valence(place.patch);
  Real rows[9];
  kernels<Real>().evaluate(&s.domain[s.domain_begin[n]], control_of(s, place.patch),
                           s.form[place.patch], n, &xi, &eta, 1, 1, rows);
  const std::uint32_t slot = 0;
  SurfacePoint point;
  surface_points(cache, s, {&place.patch, 1}, {&slot, 1}, rows, 1, {&point, 1});
  return point;
}

constexpr std::size_t kSparse = 3;

// Evaluates sparse points, nearly as many patches as points: in packed lanes, not block by block.
template <class Real>
void evaluate_each(const PatchCache& cache, const Surface<Real>& s, const PointBlocks<Real>& blocks,
                   std::span<SurfacePoint> out) {
  thread_local std::vector<std::uint32_t> slot;
  thread_local std::vector<Real> xi, eta, rows;
  const std::size_t count = out.size(), stride = row_stride(count);
  slot.resize(count), xi.resize(count), eta.resize(count);
  rows.resize(9 * stride);
  for (std::size_t i = 0; i < count; ++i) {
    xi[i] = blocks.xi[blocks.slot[i]];
    eta[i] = blocks.eta[blocks.slot[i]];
  }
  std::iota(slot.begin(), slot.end(), 0u);
  kernels<Real>().evaluate_each(s, blocks.patch_of.data(), xi.data(), eta.data(), count, stride,
                                rows.data());
  surface_points<Real>(cache, s, blocks.patch_of, slot, rows.data(), stride, out);
}

template <class Real>
void evaluate_points(const PatchCache& cache, const Surface<Real>& s,
                     std::span<const DomainPoint> points, std::span<SurfacePoint> out) {
  thread_local PointBlocks<Real> blocks;
  thread_local std::vector<Real> rows;
  const auto lanes = static_cast<std::size_t>(kernels<Real>().lanes);
  block_points(cache, s, points, lanes, blocks);
  // A block of a few points of one patch costs as much as a full one.
  if (blocks.slots() > kSparse * points.size()) return evaluate_each(cache, s, blocks, out);
  const std::size_t stride = row_stride(blocks.slots()), count = blocks.patch.size();
  rows.resize(9 * stride);
  for (std::size_t first = 0, end; first < count; first = end) {
    const std::uint32_t patch = blocks.patch[first], n = s.valence(patch);
    for (end = first + 1; end < count && blocks.patch[end] == patch;) ++end;
    const std::size_t at = first * lanes;
    kernels<Real>().evaluate(&s.domain[s.domain_begin[n]], control_of(s, patch), s.form[patch], n,
                             &blocks.xi[at], &blocks.eta[at], (end - first) * lanes, stride,
                             &rows[at]);
  }
  surface_points<Real>(cache, s, blocks.patch_of, blocks.slot, rows.data(), stride, out);
}

template <class Real>
std::vector<RawHip<Real>> raw_hips(const PatchCache& cache, std::span<const Vec3> hips) {
  std::vector<RawHip<Real>> raw(hips.size());
  for (std::size_t i = 0; i < hips.size(); ++i) raw[i] = raw_hip<Real>(cache, hips[i]);
  return raw;
}

}  // namespace

void require_room(std::size_t room, std::size_t needed) {
  if (room < needed) {
    throw std::invalid_argument("a batch of " + std::to_string(needed) +
                                " has room or starts for " + std::to_string(room) + " only");
  }
}

DomainPoint on_side(std::uint32_t face, std::uint32_t n, std::uint32_t k, double t) {
  const DomainVec X = on_side(n, k, t);
  return {face, X.x(), X.y()};
}

bool in_domain(const PatchCache& cache, const DomainPoint& point) {
  if (point.face >= cache.face_patch.size() || cache.face_patch[point.face] == kNone) return false;
  return with_surface(cache, [&](const auto& s) {
    const std::uint32_t n = cache.face_valence[point.face];
    for (std::uint32_t k = 0; k < n; ++k) {
      const Eigen::Vector2d a = domain_corner(s, n, k), b = domain_corner(s, n, (k + 1) % n),
                            x(point.xi, point.eta);
      const double area = (b - a).x() * (x - a).y() - (b - a).y() * (x - a).x();
      if (!(area >= -1e-6 * (b - a).norm())) return false;
    }
    return true;
  });
}

SurfacePoint evaluate(const PatchCache& cache, const DomainPoint& point) {
  require_patches(cache);
  const PlainArithmetic plain;
  return with_surface(cache, [&](const auto& s) { return evaluate_point(cache, s, point); });
}

void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
              std::span<SurfacePoint> out) {
  require_patches(cache);
  require_room(out.size(), points.size());
  const PlainArithmetic plain;
  with_surface(cache,
               [&](const auto& s) { evaluate_points(cache, s, points, out.first(points.size())); });
}

Contact nearest(const PatchCache& cache, const Vec3& hip, const QueryOptions& options) {
  Contact contact;
  nearest(cache, hip, {&options.method, 1}, options, {&contact, 1});
  return contact;
}

void nearest(const PatchCache& cache, const Vec3& hip, std::span<const Method> methods,
             const QueryOptions& options, std::span<Contact> out) {
  require_patches(cache);
  require_room(kMethods, methods.size());
  require_room(out.size(), methods.size());
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    std::array<RawContact<Real>, kMethods> raw;
    const RawHip<Real> there = raw_hip<Real>(cache, hip);
    kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options), &there,
                            1, raw.data());
    for (std::size_t i = 0; i < methods.size(); ++i) out[i] = contact_of(cache, s, raw[i]);
  });
}

void nearest(const PatchCache& cache, std::span<const Vec3> hips, std::span<const Method> methods,
             const QueryOptions& options, std::size_t stride, Contact* out) {
  require_patches(cache);
  require_room(kMethods, methods.size());
  require_room(stride, hips.size());
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    const std::vector<RawHip<Real>> there = raw_hips<Real>(cache, hips);
    std::vector<RawContact<Real>> raw(hips.size() * methods.size());
    kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options),
                            there.data(), there.size(), raw.data());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const std::size_t hip = i / methods.size(), method = i % methods.size();
      out[method * stride + hip] = contact_of(cache, s, raw[i]);
    }
  });
}

void track(const PatchCache& cache, std::span<const Vec3> hips, std::span<const DomainPoint> starts,
           const QueryOptions& options, std::span<Contact> out) {
  require_patches(cache);
  require_room(starts.size(), hips.size());
  require_room(out.size(), hips.size());
  const PlainArithmetic plain;
  with_surface(cache, [&]<class Real>(const Surface<Real>& s) {
    const std::vector<RawHip<Real>> there = raw_hips<Real>(cache, hips);
    std::vector<RawContact<Real>> states(hips.size());
    for (std::size_t i = 0; i < states.size(); ++i)
      place_at(place_of(cache, s, starts[i]), states[i]);
    kernels<Real>().track(s, options.method, track_options<Real>(options), there.data(),
                          there.size(), states.data());
    for (std::size_t i = 0; i < states.size(); ++i) out[i] = contact_of(cache, s, states[i]);
  });
}

}  // namespace gliss
