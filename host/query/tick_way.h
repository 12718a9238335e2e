// The way of a free HIP in a tick: where it meets a surface.
#pragma once

#include <optional>

#include "gliss/query/tick_kernel.h"

namespace gliss {

// How the way of a free HIP ends.
template <class Real>
struct WayEnd {
  RawContact<Real> contact;  // touching, or free
  bool is_reached = true;    // else the tick's evaluations did not suffice: ...
  Vec3 hip = Vec3::Zero();   // ... the next tick goes on from here
  double clear = 0;          // where no surface is nearer
  bool behind = false;       // the HIP is behind an open surface
};

// Sphere tracing (Hart 1996): the balls round both ends hold no surface, nor does that round any
// point between. A way that they cover crosses none.
template <class Real>
class TickWay {
 public:
  using Raw = RawContact<Real>;

  // From `from`, to which no surface is nearer than `clear`, to `to`. `behind`: it begins behind an
  // open surface.
  TickWay(TickKernel<Real>& kernel, const Vec3& from, double clear, bool behind, const Vec3& to)
      : kernel_(kernel),
        from_(from),
        to_(to),
        way_(to - from),
        length_(way_.norm()),
        glide_(0x1p-12 / kernel.scale()),
        at_(clear > 0 ? clear : std::min(4 * kernel.on_surface(), length_)),
        behind_(behind) {}

  // `end`: the nearest point to where it ends. begins_on_it: the free HIP was on the surface.
  WayEnd<Real> go(const Raw& end, bool begins_on_it) {
    glided_ = was_near_ = begins_on_it;
    const double until = std::min(uncovered(end), length_);
    while (at_ < until) {
      const Vec3 x = place(at_);
      const Raw there = kernel_.nearest(x, kSearch);
      const Contact found = kernel_.contact(there);
      const double clear = kernel_.clear_of(found);
      if (const std::optional<Raw> met = look(x, there, clear)) return {*met};
      const double step = step_from(x, found, clear);
      if (!kernel_.may_search())
        return free(end, false, glided_ ? place(at_ + step) : x, glided_ ? 0 : clear);
      at_ += step;
    }
    if (!kernel_.is_sure(end)) return free(end, false, to_, kernel_.clear_of(end));
    // A HIP that was near a surface, or is on it, and ends inside has come in, though its place was
    // not found.
    was_near_ = was_near_ || kernel_.clear_of(end) <= kernel_.on_surface();
    const bool may_enter = kernel_.is_closed_at(end) || (was_near_ && !behind_);
    if (may_enter && kernel_.is_touching(end)) return {end};
    behind_ = kernel_.is_touching(end);
    return free(end, true, to_, kernel_.clear_of(end));
  }

 private:
  static constexpr int kSearch = 128;  // evaluations for a point, where a bound is enough
  static constexpr double kSteps = 16;

  Vec3 place(double at) const { return from_ + (std::min(at, length_) / length_) * way_; }
  // How far from its begin the way is not covered by the ball round its end. From where squares
  // overflow nothing is swept.
  double uncovered(const Raw& end) const {
    if (!std::isfinite(length_)) return 0;
    const bool crosses = kernel_.is_sure(end) && kernel_.is_touching(end) != behind_;
    return length_ - kernel_.clear_of(end) + (crosses ? 1 : -1) * kernel_.on_surface();
  }
  // The contact that begins at x, if the way enters there, taken along to the end.
  std::optional<Raw> look(const Vec3& x, const Raw& there, double clear) {
    const bool meets = clear <= kernel_.on_surface(),
               is_in = kernel_.is_touching(there) && !kernel_.is_unfinished(there),
               is_closed = kernel_.is_closed_at(there);
    if (!behind_ && (meets || (is_in && (glided_ || is_closed)))) {
      const Raw inside = follow(x, there);
      if (kernel_.is_touching(inside)) return inside;
    }
    if (!meets) behind_ = is_in && !is_closed;
    return {};
  }
  // Takes a contact that began at x along to the HIP, as slower hands do: where it ends in a thin
  // part depends on the way. As many steps as the tick may spend.
  Raw follow(const Vec3& x, Raw contact) {
    const Vec3 way = to_ - x;
    const double steps = std::clamp(std::ceil(way.norm() / glide_), 1.0, kSteps);
    for (double step = 1; step <= steps; ++step) {
      if (!kernel_.may_track()) step = steps;
      contact = kernel_.track(contact, step < steps ? Vec3(x + step / steps * way) : to_);
    }
    return contact;
  }
  // Close to a surface it glides, towards it no farther than to its tangent plane.
  double step_from(const Vec3& x, const Contact& found, double clear) {
    const bool meets = clear <= kernel_.on_surface();
    const double towards = (found.scp - x).dot(way_) / length_;
    double step = std::min(glide_, length_);
    if (!meets && towards > 0) step = std::min(step, clear * clear / towards);
    glided_ = step > clear;
    was_near_ = was_near_ || glided_ || meets;
    return std::max(step, clear);
  }
  WayEnd<Real> free(Raw end, bool is_reached, const Vec3& x, double clear) const {
    end.uints[kContactState] = 0;
    return {end, is_reached, x, clear, behind_};
  }

  TickKernel<Real>& kernel_;
  const Vec3 from_, to_, way_;
  const double length_, glide_;  // glide_: longest step that the ball round a point does not cover
  double at_;                    // how far along the way
  bool behind_, glided_ = false, was_near_ = false;
};

}  // namespace gliss
