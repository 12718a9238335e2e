#include "host/query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "host/frames.h"
#include "host/patch_batch.h"
#include "host/point_blocks.h"

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

// As many points as patches, nearly: not block by block.
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

template <class Real>
void place_at(const PatchPlace& place, RawContact<Real>& state) {
  state.uints[kContactPatch] = place.patch;
  state.reals[kContactXi] = static_cast<Real>(place.xi);
  state.reals[kContactEta] = static_cast<Real>(place.eta);
}

}  // namespace

DomainPoint on_side(std::uint32_t face, std::uint32_t n, std::uint32_t k, double t) {
  const Eigen::Vector2d X = on_side(n, k, t);
  return {face, X.x(), X.y()};
}

bool in_domain(const PatchCache& cache, const DomainPoint& point) {
  if (point.face >= cache.mesh_face_count || cache.face_patch[point.face] == kNone) return false;
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
  return with_surface(cache, [&](const auto& s) { return evaluate_point(cache, s, point); });
}

void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
              std::span<SurfacePoint> out) {
  with_surface(cache, [&](const auto& s) { evaluate_points(cache, s, points, out); });
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
    const RawHip<Real> there = raw_hip<Real>(cache, hip);
    kernels<Real>().nearest(s, methods.data(), methods.size(), track_options<Real>(options), &there,
                            1, raw.data());
    for (std::size_t i = 0; i < methods.size(); ++i) out[i] = contact_of(cache, s, raw[i]);
  });
}

void nearest(const PatchCache& cache, std::span<const Vec3> hips, std::span<const Method> methods,
             const QueryOptions& options, std::size_t stride, Contact* out) {
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

ContactTracker::ContactTracker(const PatchCache& cache, const QueryOptions& options)
    : cache_(&cache), options_(options) {
  if (cache.surface.index() == 1) state_.emplace<1>();
}

// Sphere tracing: along the line from the last HIP no surface is nearer than the last distance
// found (Hart 1996). Leaves `state` in contact where the line enters and the HIP stays inside. Adds
// the iterations spent; false where they are used up before the HIP is reached: `state` is then the
// nearest point to where the sweep has come, from where the next tick goes on.
template <class Real>
bool ContactTracker::meet(const Surface<Real>& s, const Vec3& hip, RawContact<Real>& state,
                          int& iterations) {
  constexpr int kMostSteps = 32;
  const double length = (hip - last_).norm(), on_surface = 1e-6 / cache_->scale;
  const TrackOptions<Real> options = track_options<Real>(options_);
  const RawHip<Real> end = raw_hip<Real>(*cache_, hip);
  double at = clear_;
  for (int i = 0; i < kMostSteps && at < length; ++i) {
    RawContact<Real> there;
    const Vec3 x = last_ + (at / length) * (hip - last_);
    const RawHip<Real> raw_x = raw_hip<Real>(*cache_, x);
    kernels<Real>().nearest(s, &options_.method, 1, options, &raw_x, 1, &there);
    iterations += static_cast<int>(there.uints[kContactIterations]);
    const Contact found = contact_of(*cache_, s, there);
    const double distance = std::abs(found.distance);
    double least = length / kMostSteps;  // it may glide on the surface
    if (there.uints[kContactState] != 0 || distance <= on_surface) {
      RawContact<Real> inside = there;
      kernels<Real>().track(s, options_.method, options, &end, 1, &inside);
      iterations += static_cast<int>(inside.uints[kContactIterations]);
      if (inside.uints[kContactState] != 0) {
        state = inside;
        return true;
      }
    }
    // Towards the surface no farther than to its tangent plane, or a thin part is jumped over.
    const double towards = (found.scp - x).dot(hip - last_) / length;
    if (distance > on_surface && towards > 0)
      least = std::min(least, distance * distance / towards);
    const double step = std::max(distance, least);
    at += step;
    if (iterations >= kSweepIterations && hip.allFinite()) {
      const bool clear = there.uints[kContactState] == 0 && distance == step;
      last_ = clear ? x : at < length ? Vec3(x + (step / length) * (hip - last_)) : hip;
      clear_ = clear ? distance : 0;
      state = there;
      state.uints[kContactState] = 0;
      return false;
    }
  }
  return true;
}

Contact ContactTracker::tick(const Vec3& hip) noexcept {
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) {
    RawContact<Real>& state = *std::get_if<RawContact<Real>>(&state_);
    // Where it is clear, nothing is learnt: a caller that does not ask there gets the same
    // contacts.
    const bool was_free = !touching(), clear = is_clear(hip);
    int iterations = 0;
    const bool sweeps = was_free && !clear && clear_ >= 0;
    const bool arrived = !sweeps || meet(s, hip, state, iterations);
    const bool met = was_free && touching();
    if (arrived && !met) {
      kernels<Real>().tick(s, options_.method, track_options<Real>(options_),
                           raw_hip<Real>(*cache_, hip), &state);
      iterations += static_cast<int>(state.uints[kContactIterations]);
    }
    Contact contact = contact_of(*cache_, s, state);
    contact.iterations = iterations;
    if (arrived && hip.allFinite() && !clear) {
      last_ = hip;
      // What local tracking leaves need not be the nearest of all.
      clear_ = was_free && !contact.touching ? contact.distance : 0;
    }
    return contact;
  });
}

Contact ContactTracker::track(const Vec3& hip, const DomainPoint& start) noexcept {
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) {
    RawContact<Real>& state = *std::get_if<RawContact<Real>>(&state_);
    place_at(place_of(*cache_, s, start), state);
    const RawHip<Real> there = raw_hip<Real>(*cache_, hip);
    kernels<Real>().track(s, options_.method, track_options<Real>(options_), &there, 1, &state);
    if (hip.allFinite()) {
      last_ = hip;
      clear_ = 0;
    }
    return contact_of(*cache_, s, state);
  });
}

void ContactTracker::release(const Vec3& hip, double clear) noexcept {
  std::visit([](auto& state) { state.uints[kContactState] = 0; }, state_);
  last_ = hip;
  clear_ = clear;
}

void ContactTracker::move_to(const PatchCache& cache) noexcept {
  std::visit(
      [&](auto& state) {
        std::uint32_t& patch = state.uints[kContactPatch];
        const std::uint32_t face = cache_->patch_face[patch], first = cache.face_patch[face];
        // Free, the patch is only remembered.
        patch = first == kNone ? 0 : first + (patch - cache_->face_patch[face]);
      },
      state_);
  cache_ = &cache;
}

bool ContactTracker::touching() const {
  return std::visit([](const auto& state) { return state.uints[kContactState] != 0; }, state_);
}

}  // namespace gliss
