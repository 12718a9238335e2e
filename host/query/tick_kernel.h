// The questions of one tick of a ContactTracker to its surface, in the cache's own precision, and
// the account of what they spend.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/query/contact_tracker.h"
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"

namespace gliss {

template <class Real>
class TickKernel {
 public:
  using Raw = RawContact<Real>;

  // All three outlive it.
  TickKernel(const PatchCache& cache, const Surface<Real>& surface, const QueryOptions& options)
      : cache_(cache),
        s_(surface),
        method_(options.method),
        options_(track_options<Real>(options)),
        on_surface_(1e-6 / cache.scale),
        rounding_(2 * static_cast<double>(std::numeric_limits<Real>::epsilon()) / cache.scale) {}

  // The nearest point of the surface. A budget counts evaluations, here as below.
  Raw nearest(const Vec3& x, int budget = kSearchEvaluations) {
    Raw found;
    const RawHip<Real> there = raw_hip<Real>(cache_, x);
    kernels<Real>().nearest(s_, &method_, 1, within(budget), &there, 1, &found);
    correct_state(cache_, method_, there, found);
    ++searches_;
    return spend(found);
  }
  // The contact that goes on from `from`, as the HIP, or what stands for it, goes to x: with what
  // the last tick knows of its way.
  Raw follow(Raw from, const Vec3& x) {
    kernels<Real>().tick(s_, method_, within(half()), raw_hip<Real>(cache_, x), &from);
    return spend(from);
  }
  // The local nearest point to x that a place of the surface leads to.
  Raw track(const Raw& from, const Vec3& x) { return track(from, x, options_.max_iterations); }
  // The same place, as it is seen from x.
  Raw look_from(const Vec3& x, const Raw& place) { return track(place, x, 0); }
  Raw at(const DomainPoint& point) const {
    Raw raw{};
    place_at(place_of(cache_, s_, point), raw);
    return raw;
  }

  Contact contact(const Raw& raw) const { return contact_of(cache_, s_, raw); }
  // SCP - HIP, mesh's unit.
  Vec3 offset(const Raw& raw) const {
    const Eigen::Map<const Eigen::Matrix<Real, 3, 1>> v(&raw.reals[kContactOffset]);
    return v.template cast<double>() / cache_.scale;
  }
  // Writes SCP - HIP and the push, mesh's unit.
  void store(Raw& raw, const Vec3& offset, const Vec3& push) const {
    for (int i = 0; i < 3; ++i) {
      raw.reals[kContactOffset + i] = static_cast<Real>(offset[i] * cache_.scale);
      raw.reals[kContactPush + i] = static_cast<Real>(push[i] * cache_.scale);
    }
  }
  // True if a HIP may be deeper beneath a contact point than the radius of curvature is there.
  bool is_beyond_radius(const Raw& raw, double depth) const {
    const Real* numbers = &s_.patch[kPatchReals * std::size_t{raw.uints[kContactPatch]}];
    return depth * cache_.scale *
               static_cast<double>(numbers[kPatchCurvature] * numbers[kPatchScale]) >
           1;
  }
  static bool is_touching(const Raw& raw) { return raw.uints[kContactState] != 0; }
  static bool is_unfinished(const Raw& raw) {
    return (raw.uints[kContactFlags] & kUnfinished) != 0;
  }
  static bool is_on_border(const Raw& raw) { return (raw.uints[kContactFlags] & kOnBorder) != 0; }
  bool is_closed_at(const Raw& raw) const { return cache_.is_closed_at(raw.uints[kContactPatch]); }

  // No point of the surface is nearer than that to where a search was made.
  double clear_of(const Raw& raw) const { return clear_of(contact(raw)); }
  static double clear_of(const Contact& found) {
    return found.flags & kUnfinished ? found.clear : std::abs(found.distance);
  }
  // True if the search ended, or nothing is nearer by more than a hundredth of the way: in the
  // middle of a ball no search ends within a tick, nor does it matter.
  bool is_sure(const Raw& found) const {
    const Contact c = contact(found);
    return !is_unfinished(found) || clear_of(c) >= 0.99 * std::abs(c.distance);
  }

  Method method() const { return method_; }
  double scale() const { return cache_.scale; }
  double on_surface() const { return on_surface_; }  // closer is on it, mesh's unit
  double rounding() const { return rounding_; }      // of a place on the surface, mesh's unit
  // Evaluations after the first, as a contact's iterations tell them.
  int iterations() const { return std::max(0, told_ - 1); }
  int half() const { return left() / 2; }  // of the evaluations that searches may still spend
  bool may_search() const {
    return spent_ < kSearchEvaluations && searches_ < ContactTracker::kTickSearches;
  }
  bool may_track() const { return spent_ + options_.max_iterations < kSearchEvaluations; }

 private:
  // No search begins after as many: six descents of 64 steps may follow.
  static constexpr int kSearchEvaluations = ContactTracker::kTickEvaluations - 6 * 65;

  int left() const { return kSearchEvaluations - spent_; }  // evaluations
  TrackOptions<Real> within(int budget) const {
    TrackOptions<Real> options = options_;
    options.budget = std::max(1, std::min(budget, left()));
    return options;
  }
  Raw track(Raw from, const Vec3& x, int iterations) {
    TrackOptions<Real> options = within(left());
    options.max_iterations = iterations;
    const RawHip<Real> there = raw_hip<Real>(cache_, x);
    kernels<Real>().track(s_, method_, options, &there, 1, &from);
    return spend(from);
  }
  const Raw& spend(const Raw& raw) {
    spent_ += std::max(1, raw.evaluations);
    told_ += static_cast<int>(raw.uints[kContactIterations]) + 1;
    return raw;
  }

  const PatchCache& cache_;
  const Surface<Real>& s_;
  const Method method_;
  const TrackOptions<Real> options_;
  const double on_surface_, rounding_;
  int spent_ = 0, told_ = 0, searches_ = 0;
};

}  // namespace gliss
