#include "gliss/query/contact_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/frames.h"
#include "gliss/query/tick_drag.h"
#include "gliss/query/tick_kernel.h"
#include "gliss/query/tick_time.h"
#include "gliss/query/tick_way.h"

namespace gliss {
namespace {

// True if its push is the way to the nearest point, whose size tells its energy.
bool has_energy(Method method) { return method != Method::kShaded; }

}  // namespace

// One tick, in the cache's own precision. First the contact follows its HIP, dragged by friction,
// or is looked for along the way of a free one. Then what is felt of it settles.
template <class Real>
class ContactTracker::Tick {
 public:
  using Raw = RawContact<Real>;

  Tick(ContactTracker& tracker, const Surface<Real>& surface, const Vec3& hip, double dt)
      : t_(tracker),
        kernel_(*tracker.cache_, surface, tracker.options_),
        state_(*std::get_if<Raw>(&tracker.state_)),
        hip_(hip),
        dt_(dt) {}

  Contact run() {
    if (!hip_.allFinite() || t_.is_clear(hip_)) return look_only();
    const bool is_first = t_.past_.clear < 0;
    if (!t_.felt_.is_on()) return find(is_first);
    const bool was_touching = t_.follows();
    // Through a ball without a surface it went freely.
    if (!is_first) t_.felt_.move(hip_, t_.past_.clear, dt_);
    const Contact now = find(is_first);
    if (!is_first) return feel(now, was_touching);
    t_.felt_.begin(hip_, now);
    return now;
  }

  // The tick of a contact that another tracker had, at a point of the surface.
  Contact take_over(const DomainPoint& start, const Friction* friction) {
    const Vec3 lag =
        friction != nullptr && friction->has_grip() ? friction->lag() : Vec3(Vec3::Zero());
    state_ = kernel_.track(kernel_.at(start), hip_ + lag);
    if (hip_.allFinite()) t_.past_ = {hip_, 0};
    if (!t_.friction_.is_on()) return contact(state_);
    begin_friction();
    if (!lag.isZero(0) && t_.friction_.has_grip()) {
      t_.friction_ = *friction;
      const Contact to = kernel_.contact(state_);
      const Vec3 offset = to.scp - hip_,
                 axis = drag().axis_of(t_.options_.method, to, offset - lag);
      state_ = drag().felt(state_, offset, axis, friction->slips());
    }
    return contact(state_);
  }

 private:
  // The contact as it is, whatever is felt.
  Contact find(bool is_first) {
    if (t_.follows()) return follow();
    const Raw end = kernel_.nearest(hip_, kernel_.half());
    return is_first ? accept(end) : arrive(end, t_.past_.clear <= kernel_.on_surface());
  }

  Contact follow() {
    const bool is_dragged = t_.friction_.has_grip();
    const Raw next = is_dragged ? drag().drag() : kernel_.follow(state_, hip_);
    if (kernel_.is_touching(next))
      return kernel_.is_unfinished(next) && hold() ? contact(state_) : accept(next, is_dragged);
    double moved = (hip_ - t_.past_.hip).norm();
    if (is_dragged) moved += t_.friction_.slack(moved);
    const Contact gone = kernel_.contact(next);
    const Raw end = kernel_.nearest(hip_, kernel_.half());
    // A HIP that has come out within this tick is no farther from the surface than it has moved.
    const bool is_out = kernel_.is_on_border(next) || gone.distance <= moved + kernel_.on_surface();
    if (!is_out && kernel_.is_touching(end)) return accept(end);
    t_.past_ = {gone.scp, 0, false, t_.past_.held_push};
    return arrive(end, false);
  }

  // A free HIP has come from where it was last looked for; `end` is the nearest point now.
  Contact arrive(const Raw& end, bool begins_on_it) {
    const Past& past = t_.past_;
    const WayEnd<Real> way =
        TickWay<Real>(kernel_, past.hip, past.clear, past.behind, hip_).go(end, begins_on_it);
    if (!way.is_reached && t_.follows() && !is_outside(end) && hold()) return contact(state_);
    const Contact found = accept(way.contact);
    if (!kernel_.is_touching(way.contact)) t_.past_ = {way.hip, way.clear, way.behind};
    return found;
  }

  // True if the HIP of a contact, which has gone to where it is not touching, lies outside, as far
  // as is known: a farther place that a search had found when it was cut off does not count.
  bool is_outside(const Raw& end) const {
    const double gone = (t_.past_.hip - hip_).norm();
    return !kernel_.is_touching(end) ||
           (!kernel_.is_sure(end) && kernel_.offset(end).norm() >= gone - kernel_.on_surface());
  }

  // Turns the contact to what is felt of it.
  Contact feel(Contact now, bool was_touching) {
    // The lag changes by the slack at most, and the push of the slider by twice its way.
    if (t_.friction_.is_on() && was_touching)
      t_.felt_.allow(3 * t_.friction_.slack(t_.felt_.way()));
    t_.felt_.feel(now, has_energy(t_.options_.method));
    return now;
  }

  TickDrag<Real> drag() { return {kernel_, t_.friction_, state_, hip_, dt_}; }
  Contact contact(const Raw& raw) const {
    Contact c = kernel_.contact(raw);
    c.iterations = kernel_.iterations();
    return c;
  }
  // The nearest point, without a contact.
  Contact look_only() {
    Raw found = kernel_.nearest(hip_);
    found.uints[kContactState] = 0;
    return contact(found);
  }

  // The tick ends with `raw` for its state. is_dragged: that has its friction.
  Contact accept(const Raw& raw, bool is_dragged = false) {
    state_ = raw;
    t_.past_ = {hip_, kernel_.is_touching(raw) ? 0 : kernel_.clear_of(raw)};
    if (t_.friction_.is_on() && !is_dragged) begin_friction();
    return contact(raw);
  }
  // A contact begins, or one without friction goes on: that has it once it has left the border.
  void begin_friction() {
    const Contact c = kernel_.contact(state_);
    t_.friction_.begin(TickDrag<Real>::axis_of(t_.options_.method, c, c.scp - hip_),
                       c.touching && !kernel_.is_on_border(state_));
  }

  // The tick ends with the SCP where it was, as what the tick may spend does not tell where it
  // goes, nor if it has ended. False if the HIP has come out of there, or is four times as deep as
  // at first.
  bool hold() {
    Raw same = kernel_.look_from(hip_, state_);
    double& at_first = t_.past_.held_push;
    if (at_first == 0) at_first = kernel_.offset(state_).norm();
    const Vec3 offset = kernel_.offset(same);
    if (!(offset.dot(kernel_.contact(same).normal) > 0 && offset.norm() <= 4 * at_first))
      return false;
    same.uints[kContactState] = 1;
    same.uints[kContactFlags] &= ~kConverged;
    state_ = same;
    t_.past_.hip = hip_;
    return true;
  }

  ContactTracker& t_;
  TickKernel<Real> kernel_;
  Raw& state_;
  const Vec3 hip_;
  const double dt_;  // s
};

namespace {

// The contact with a cache that was moved from under the tracker.
Contact no_surface() {
  Contact c;
  c.push.setConstant(std::numeric_limits<double>::quiet_NaN());
  return c;
}

}  // namespace

ContactTracker::ContactTracker(const PatchCache& cache, const QueryOptions& options)
    : cache_(&cache),
      options_(options),
      felt_(options.settle, 1e-6 / cache.scale),
      friction_(options.friction) {
  require_patches(cache);
  if (!(options.settle >= 0 && options.settle <= kMostSettleTime))
    throw std::invalid_argument("QueryOptions has a settle that is not from 0 to 1 s");
  if (const char* fault = fault_of(options.friction))
    throw std::invalid_argument(std::string("QueryOptions ") + fault);
  if (cache.surface.index() == 1) state_.emplace<1>();
}

Contact ContactTracker::tick(const Vec3& hip, double dt) noexcept {
  if (cache_->patch_count() == 0) return no_surface();
  const PlainArithmetic plain;
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) {
    return Tick<Real>(*this, s, hip, tick_time(dt)).run();
  });
}

Contact ContactTracker::track(const Vec3& hip, const DomainPoint& start, const Settling* felt,
                              const Friction* friction, double dt) noexcept {
  if (cache_->patch_count() == 0) return no_surface();
  const PlainArithmetic plain;
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) {
    dt = tick_time(dt);
    Contact contact = Tick<Real>(*this, s, hip, dt).take_over(start, friction);
    if (!felt_.is_on() || !hip.allFinite()) return contact;
    if (felt == nullptr) {
      felt_.begin(hip, contact);
    } else {
      felt_ = *felt;
      felt_.move(hip, 0, dt);
      felt_.feel(contact, has_energy(options_.method));
    }
    return contact;
  });
}

bool ContactTracker::set_friction(const FrictionOptions& friction) noexcept {
  if (fault_of(friction) != nullptr) return false;
  options_.friction = friction;
  friction_.change(friction);
  return true;
}

// From the state as a start, the HIP's own nearest point and those of HIPs beside it, to both sides
// along each axis.
template <class Real>
ContactFoot ContactTracker::foot_on(const Surface<Real>& s, const Vec3& hip) const {
  constexpr std::size_t kFeet = 7;
  const RawContact<Real>& state = *std::get_if<RawContact<Real>>(&state_);
  const std::size_t numbers = kPatchReals * std::size_t{state.uints[kContactPatch]};
  const double step = std::cbrt(static_cast<double>(std::numeric_limits<Real>::epsilon())) /
                      cache_->scale * static_cast<double>(s.patch[numbers + kPatchUnscale]);
  RawHip<Real> hips[kFeet];
  RawContact<Real> feet[kFeet];
  for (int i = 0; i < static_cast<int>(kFeet); ++i) {
    const Vec3 aside = (i % 2 == 0 ? step : -step) * Vec3::Unit(i / 2 % 3);
    hips[i] = raw_hip<Real>(*cache_, i == kFeet - 1 ? hip : Vec3(hip + aside));
    feet[i] = state;
  }
  kernels<Real>().track(s, options_.method, track_options<Real>(options_), hips, kFeet, feet);
  const auto contact = [&](int i) { return contact_of(*cache_, s, feet[i]); };
  const Contact own = contact(kFeet - 1);
  ContactFoot foot{own.scp, own.push, own.push.norm()};
  if (has_energy(options_.method))
    foot.depth = std::sqrt(std::max(0.0, own.push.dot(own.scp - hip)));
  for (int axis = 0; axis < 3; ++axis)
    foot.moves.col(axis) = (contact(2 * axis).scp - contact(2 * axis + 1).scp) / (2 * step);
  const double moves = foot.moves.norm();
  if (!(moves <= kMostMoves)) foot.moves *= std::isfinite(moves) ? kMostMoves / moves : 0;
  return foot;
}

ContactFoot ContactTracker::foot(const Vec3& hip, const Contact& contact) const noexcept {
  ContactFoot stays{contact.scp, contact.push, contact.push.norm()};
  const bool is_nearest = (contact.flags & (kConverged | kSlipping)) != 0;
  if (!contact.touching || is_settling(contact.flags) || !is_nearest) return stays;
  const PlainArithmetic plain;
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) { return foot_on(s, hip); });
}

void ContactTracker::release(const Vec3& hip, double clear) noexcept {
  std::visit([](auto& state) { state.uints[kContactState] = 0; }, state_);
  past_ = {hip, clear};
  felt_.begin_free(hip);
}

void ContactTracker::move_to(const PatchCache& cache) noexcept {
  std::visit(
      [&](auto& state) {
        std::uint32_t& patch = state.uints[kContactPatch];
        state.held_count = 0;
        const std::uint32_t face = cache_->patch_face[patch], first = cache.first_patch(face);
        // Free, the patch is only remembered.
        patch = first == kNone ? 0 : first + (patch - cache_->first_patch(face));
      },
      state_);
  cache_ = &cache;
}

bool ContactTracker::follows() const {
  return std::visit([](const auto& state) { return state.uints[kContactState] != 0; }, state_);
}

}  // namespace gliss
