// Friction in a tick: the contact point stays where the HIP is in its cone, and else is dragged
// behind it (docs/method.md, Friction).
#pragma once

#include "gliss/query/tick_kernel.h"

namespace gliss {

template <class Real>
class TickDrag {
 public:
  using Raw = RawContact<Real>;

  // `last`: the last tick's contact, `dt` (s) ago. All outlive it.
  TickDrag(TickKernel<Real>& kernel, Friction& friction, const Raw& last, const Vec3& hip,
           double dt)
      : kernel_(kernel), friction_(friction), last_(last), hip_(hip), dt_(dt) {}

  // The contact point stays where the HIP is in its cone. Else it is the nearest point to a slider
  // that lags behind the HIP, by the tangential part of the push: a lag that is corrected until it
  // meets the cone at the point found. The point comes nearer to the HIP, or else goes without
  // friction. Ends free where the slider has come out.
  Raw drag() {
    const Vec3 offset = kernel_.contact(last_).scp - hip_;
    const bool was_on_border = kernel_.is_on_border(last_);
    // Friction holds a contact for no longer than there is one without: where the HIP has gone
    // through a ball, or left over an edge, that has come out. Past a border friction fades by its
    // own law, unless the place is no nearest one any more.
    const Raw without = kernel_.track(last_, hip_);
    const bool fades =
        kernel_.is_on_border(without) && !kernel_.is_beyond_radius(last_, offset.norm());
    if (!kernel_.is_touching(without) && !fades) return without;
    if (friction_.holds(offset, was_on_border)) return felt(last_, offset, friction_.axis(), false);
    friction_.narrow(dt_);
    const Vec3 whole = friction_.lag_within(offset, was_on_border);
    const double most = whole.norm();
    Vec3 lag = friction_.guess() * whole;
    friction_.learn(1);
    Raw next = kernel_.follow(last_, hip_ + lag);
    for (int i = 1;; ++i) {
      const Contact to = kernel_.contact(next);
      const Vec3 there = to.scp - hip_, out = there - lag;
      const bool on_border = kernel_.is_on_border(next);
      if (!to.touching && !on_border) return next;
      const Vec3 axis = axis_of(kernel_.method(), to, out);
      const double factor = friction_.lag_factor(there, out, axis, on_border);
      if (lag.isZero(0)) return felt(next, there, axis, true);
      if (!(there.norm() <= offset.norm() + kernel_.rounding() && there.dot(axis) > 0)) {
        lag.setZero();
        next = last_;
      } else if (i < kDrags && std::abs(factor - 1) > kConeError) {
        lag *= std::min(factor, most / lag.norm());
        next.warmth[3] = next.warmth[4] = 0;
      } else {
        friction_.learn(most > 0 ? lag.norm() / most * std::min(factor, 1.0) : 1);
        return felt(next, there, axis, true);
      }
      next = kernel_.follow(next, hip_ + lag);
    }
  }

  // The contact with friction at `there`, whose offset from the HIP is another than that from the
  // slider.
  Raw felt(Raw there, const Vec3& offset, const Vec3& axis, bool slips) {
    Vec3 push = friction_.feel(offset, axis, slips, kernel_.is_on_border(there));
    if (kernel_.method() == Method::kShaded)
      push += push.dot(axis) * (kernel_.contact(there).normal - axis);
    kernel_.store(there, offset, push);
    there.uints[kContactState] = !push.isZero(0);
    std::uint32_t& flags = there.uints[kContactFlags];
    flags = (flags & ~kSlipping) | (slips ? kSlipping : kConverged);
    const bool goes_on = there.uints[kContactPatch] == last_.uints[kContactPatch];
    for (std::size_t i = 0; i < 2; ++i)
      there.warmth[3 + i] = goes_on ? there.reals[kContactXi + i] - last_.reals[kContactXi + i] : 0;
    return there;
  }

  // The direction in which a contact pushes without friction: `out` goes there from the HIP, or its
  // slider. On smooth patches it is the normal, with less rounding.
  static Vec3 axis_of(Method method, const Contact& to, const Vec3& out) {
    const bool is_smooth = method == Method::kGregory && (to.flags & kOnCrease) == 0;
    const double length = out.norm();
    return is_smooth || (to.flags & kOnBorder) != 0 || !(length > 0) ? to.normal
                                                                     : Vec3(out / length);
  }

 private:
  static constexpr int kDrags = 3;            // ways to where the lag meets the cone
  static constexpr double kConeError = 1e-6;  // at which it does

  TickKernel<Real>& kernel_;
  Friction& friction_;
  const Raw& last_;
  const Vec3 hip_;
  const double dt_;
};

}  // namespace gliss
