#include "gliss/query/contact_tracker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/force_statistics.h"
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// True if its push is the way to the nearest point, whose size tells its energy.
bool has_energy(Method method) { return method != Method::kShaded; }

}  // namespace

// One tick in the cache's own precision.
template <class Real>
class ContactTracker::Tick {
 public:
  Tick(ContactTracker& tracker, const Surface<Real>& surface, const Vec3& hip)
      : t_(tracker),
        cache_(*tracker.cache_),
        s_(surface),
        options_(track_options<Real>(tracker.options_)),
        state_(*std::get_if<RawContact<Real>>(&tracker.state_)),
        hip_(hip),
        on_surface_(1e-6 / cache_.scale),
        glide_(0x1p-12 / cache_.scale),
        rounding_(2 * double{std::numeric_limits<Real>::epsilon()} / cache_.scale) {}

  Contact run() {
    if (t_.options_.settle <= 0 || !hip_.allFinite() || t_.is_clear(hip_)) return follow();
    const bool is_first = t_.clear_ < 0;
    const RawContact<Real> last = state_;
    // Through a ball without a surface it went freely.
    if (!is_first) t_.felt_.move(hip_, t_.clear_);
    Contact now = follow();
    if (is_first) {
      t_.felt_.begin(hip_, now);
      return now;
    }
    // The lag changes by the slack at most, and the push of the slider by twice its way.
    if (t_.friction_.is_on() && is_touching(last))
      t_.felt_.allow(3 * t_.friction_.slack(t_.felt_.way()));
    if (is_touching(last) && t_.felt_.is_leap(now.push)) {
      const Vec3 was = vector_of(last, kContactPush);
      if (t_.felt_.is_leap(was, now.push)) now = slide(last, was, now);
      now.iterations = iterations();
    }
    t_.felt_.feel(now, has_energy(t_.options_.method));
    return now;
  }

  // The tick of a contact that another tracker had, at a point of the surface.
  Contact take_over(const DomainPoint& start, const Friction* friction) {
    place_at(place_of(cache_, s_, start), state_);
    const Vec3 lag =
        friction != nullptr && friction->has_grip() ? friction->lag() : Vec3(Vec3::Zero());
    const RawHip<Real> there = raw_hip<Real>(cache_, hip_ + lag);
    kernels<Real>().track(s_, t_.options_.method, options_, &there, 1, &state_);
    if (hip_.allFinite()) {
      t_.last_ = hip_;
      t_.clear_ = 0;
    }
    if (!t_.friction_.is_on()) return contact_of(cache_, s_, state_);
    begin_friction();
    if (!lag.isZero(0) && t_.friction_.has_grip()) {
      t_.friction_ = *friction;
      const Contact to = contact_of(cache_, s_, state_);
      const Vec3 offset = to.scp - hip_;
      state_ = dragged(state_, offset, axis_of(to, offset - lag), friction->slips());
    }
    return contact(state_);
  }

 private:
  // The tick without settling.
  Contact follow() {
    const bool was_touching = t_.follows();
    double moved = (hip_ - t_.last_).norm();
    if (!hip_.allFinite() || t_.is_clear(hip_)) return look_only();
    if (!was_touching) {
      const RawContact<Real> end = nearest(hip_, left() / 2);
      return t_.clear_ < 0 ? accept(end) : arrive(end, t_.clear_ <= on_surface_);
    }
    const bool has_grip = t_.friction_.has_grip();
    const RawContact<Real> next = has_grip ? drag() : follow_to(state_, hip_);
    if (is_touching(next)) return is_unfinished(next) && hold() ? contact(state_) : accept(next);
    if (has_grip) moved += t_.friction_.slack(moved);
    is_dragged_ = false;
    const Contact gone = contact_of(cache_, s_, next);
    const RawContact<Real> end = nearest(hip_, left() / 2);
    // A HIP that has come out within this tick is no farther from the surface than it has moved.
    const bool is_out = is_on_border(next) || gone.distance <= moved + on_surface_;
    if (!is_out && is_touching(end)) return accept(end);
    // No surface lies between the last HIP and this one: it has not come out, whatever the sheets
    // say that lie nearest where a surface folds over itself.
    if (!is_out && clear_of(end) > moved && !left_over_crease(next) && hold())
      return contact(state_);
    t_.last_ = gone.scp;
    t_.clear_ = 0;
    t_.behind_ = false;
    return arrive(end, false);
  }

  // The contact that follows the surface from `from` as the HIP, or what stands for it, goes there.
  RawContact<Real> follow_to(RawContact<Real> from, const Vec3& there) {
    kernels<Real>().tick(s_, t_.options_.method, within(left() / 2), raw_hip<Real>(cache_, there),
                         &from);
    pay_for(from);
    return from;
  }

  // A tick in contact with friction. The contact point stays where the HIP is in its cone. Else it
  // is the nearest point to a slider that lags behind the HIP, by the tangential part of the push:
  // a lag that is corrected until it meets the cone at the point found. The point comes nearer to
  // the HIP, or else goes without friction. Ends free where the slider has come out.
  RawContact<Real> drag() {
    Friction& friction = t_.friction_;
    const Vec3 offset = contact_of(cache_, s_, state_).scp - hip_;
    const bool was_on_border = is_on_border(state_);
    if (friction.holds(offset, was_on_border))
      return dragged(state_, offset, friction.axis(), false);
    friction.narrow();
    const Vec3 whole = friction.lag_within(offset, was_on_border);
    const double most = whole.norm();
    Vec3 lag = friction.guess() * whole;
    friction.learn(1);
    RawContact<Real> next = follow_to(state_, hip_ + lag);
    for (int i = 1;; ++i) {
      const Contact to = contact_of(cache_, s_, next);
      const Vec3 there = to.scp - hip_, out = there - lag;
      const bool on_border = is_on_border(next);
      if (!to.touching && !on_border) return next;
      const Vec3 axis = axis_of(to, out);
      const double factor = friction.lag_factor(there, out, axis, on_border);
      if (lag.isZero(0)) return dragged(next, there, axis, true);
      if (!(there.norm() <= offset.norm() + rounding_ && there.dot(axis) > 0)) {
        lag.setZero();
        next = state_;
      } else if (i < kDrags && std::abs(factor - 1) > kConeError) {
        lag *= std::min(factor, most / lag.norm());
        next.warmth[3] = next.warmth[4] = 0;
      } else {
        friction.learn(most > 0 ? lag.norm() / most * std::min(factor, 1.0) : 1);
        return dragged(next, there, axis, true);
      }
      next = follow_to(next, hip_ + lag);
    }
  }
  // The contact with friction at `there`, whose offset from the HIP is another than that from the
  // slider.
  RawContact<Real> dragged(RawContact<Real> there, const Vec3& offset, const Vec3& axis,
                           bool slips) {
    Vec3 push = t_.friction_.feel(offset, axis, slips, is_on_border(there));
    if (t_.options_.method == Method::kShaded) push += push.dot(axis) * (normal_of(there) - axis);
    store(there, offset, push);
    there.uints[kContactState] = !push.isZero(0);
    std::uint32_t& flags = there.uints[kContactFlags];
    flags = (flags & ~(kSettling | kSlipping)) | (slips ? kSlipping : kConverged);
    const bool goes_on = there.uints[kContactPatch] == state_.uints[kContactPatch];
    for (std::size_t i = 0; i < 2; ++i)
      there.warmth[3 + i] =
          goes_on ? there.reals[kContactXi + i] - state_.reals[kContactXi + i] : 0;
    is_dragged_ = true;
    return there;
  }
  // The direction in which a contact pushes without friction: `out` goes there from the HIP, or its
  // slider. Of smooth patches it is the normal, with less rounding.
  Vec3 axis_of(const Contact& to, const Vec3& out) const {
    const bool is_smooth = t_.options_.method == Method::kGregory && (to.flags & kOnCrease) == 0;
    const double length = out.norm();
    return is_smooth || (to.flags & kOnBorder) != 0 || !(length > 0) ? to.normal
                                                                     : Vec3(out / length);
  }

  // Takes the contact point from where it was towards where it leapt: downhill over the surface, or
  // straight there where that is downhill too. It stays where the evaluations do not suffice.
  // Returns the leap where no way leads downhill, or where the HIP has come out.
  Contact slide(const RawContact<Real>& last, const Vec3& was, const Contact& leapt) {
    const Contact from = contact_of(cache_, s_, last);
    const Vec3 offset = from.scp - hip_;
    const Vec3 way = leapt.touching ? Vec3(leapt.scp - from.scp) : Vec3(-offset);
    const double length = std::min(t_.felt_.reach(was, leapt.push), way.norm());
    const int descent = t_.options_.max_iterations + 1;
    for (const Vec3& towards : {Vec3(-offset), way}) {
      if (spent_ + descent > kTickEvaluations)
        return offset.dot(from.normal) > 0 ? rest(last, offset, from.normal) : leapt;
      const Vec3 along = towards - towards.dot(from.normal) * from.normal;
      if (!(along.norm() > 0)) continue;
      const Vec3 aim = from.scp + std::min(length / along.norm(), 1.0) * along;
      const RawHip<Real> there = raw_hip<Real>(cache_, aim);
      RawContact<Real> next = last;
      kernels<Real>().track(s_, t_.options_.method, within(left()), &there, 1, &next);
      pay_for(next);
      const Contact to = contact_of(cache_, s_, next);
      const Vec3 left = to.scp - hip_;
      if (left.squaredNorm() < offset.squaredNorm() && left.dot(to.normal) > 0)
        return rest(next, left, to.normal);
    }
    return leapt;
  }
  // The tick ends with the SCP at a place that is not the nearest.
  Contact rest(RawContact<Real> there, const Vec3& offset, const Vec3& normal) {
    const Vec3 push = t_.options_.method == Method::kShaded ? Vec3(offset.norm() * normal) : offset;
    store(there, offset, push);
    there.uints[kContactState] = 1;
    there.uints[kContactFlags] =
        (there.uints[kContactFlags] & ~(kConverged | kSlipping)) | kSettling;
    there.warm = false;
    if (t_.friction_.is_on()) t_.friction_.begin(normal, true);
    is_dragged_ = true;
    return accept(there);
  }

  void store(RawContact<Real>& raw, const Vec3& offset, const Vec3& push) const {
    for (int i = 0; i < 3; ++i) {
      raw.reals[kContactOffset + i] = static_cast<Real>(offset[i] * cache_.scale);
      raw.reals[kContactPush + i] = static_cast<Real>(push[i] * cache_.scale);
    }
  }
  static bool is_touching(const RawContact<Real>& raw) { return raw.uints[kContactState] != 0; }
  static bool is_unfinished(const RawContact<Real>& raw) {
    return (raw.uints[kContactFlags] & kUnfinished) != 0;
  }
  static bool is_on_border(const RawContact<Real>& raw) {
    return (raw.uints[kContactFlags] & kOnBorder) != 0;
  }
  // Of what a search or a walk over the surface has found.
  void pay_for(const RawContact<Real>& raw) {
    spent_ += std::max(1, raw.evaluations);
    told_ += static_cast<int>(raw.uints[kContactIterations]) + 1;
  }

  // kContactPush or kContactOffset, in the mesh's unit.
  Vec3 vector_of(const RawContact<Real>& raw, int first) const {
    const Eigen::Map<const Eigen::Matrix<Real, 3, 1>> v(&raw.reals[first]);
    return v.template cast<double>() / cache_.scale;
  }
  static Vec3 normal_of(const RawContact<Real>& raw) {
    return Eigen::Map<const Eigen::Matrix<Real, 3, 1>>(&raw.reals[kContactNormal])
        .template cast<double>();
  }
  int iterations() const { return std::max(0, told_ - 1); }
  int left() const { return kSearchEvaluations - spent_; }  // evaluations
  TrackOptions<Real> within(int budget) const {
    TrackOptions<Real> options = options_;
    options.budget = std::max(1, std::min(budget, left()));
    return options;
  }
  RawContact<Real> nearest(const Vec3& x, int budget = kSearchEvaluations) {
    RawContact<Real> found;
    const RawHip<Real> there = raw_hip<Real>(cache_, x);
    kernels<Real>().nearest(s_, &t_.options_.method, 1, within(budget), &there, 1, &found);
    pay_for(found);
    ++searches_;
    return found;
  }
  // No point of the surface is nearer.
  static double clear_of(const Contact& found) {
    return found.flags & kUnfinished ? found.clear : std::abs(found.distance);
  }
  double clear_of(const RawContact<Real>& raw) const {
    return clear_of(contact_of(cache_, s_, raw));
  }

  // True if the search ended, or nothing is nearer by more than a hundredth of the way: in the
  // middle of a ball no search ends within a tick, nor does it matter.
  bool is_sure(const RawContact<Real>& found) const {
    return !is_unfinished(found) ||
           clear_of(found) >= 0.99 * std::abs(contact_of(cache_, s_, found).distance);
  }

  Contact contact(const RawContact<Real>& raw) const {
    Contact c = contact_of(cache_, s_, raw);
    c.iterations = iterations();
    return c;
  }
  // The nearest point, without a contact.
  Contact look_only() {
    RawContact<Real> found = nearest(hip_);
    found.uints[kContactState] = 0;
    return contact(found);
  }

  // The tick ends with `raw` for its state.
  Contact accept(const RawContact<Real>& raw) {
    state_ = raw;
    t_.last_ = hip_;
    t_.clear_ = is_touching(raw) ? 0 : clear_of(raw);
    t_.behind_ = false;
    t_.held_push_ = 0;
    if (t_.friction_.is_on() && !is_dragged_) begin_friction();
    return contact(raw);
  }
  // A contact begins, or one without friction goes on: that has it once it has left the border.
  void begin_friction() {
    const Contact c = contact_of(cache_, s_, state_);
    t_.friction_.begin(axis_of(c, c.scp - hip_), c.touching && !is_on_border(state_));
  }
  // True if the contact went over a crease to `next`: its last normal is more like that of a face
  // beyond a crease than like that of the face where it is now. There a HIP may be outside though
  // it has crossed no surface since the last tick: the contact was held for as long as its face
  // goes on.
  bool left_over_crease(const RawContact<Real>& next) const {
    if (cache_.crease_count == 0) return false;
    const auto normal_at = [&](std::uint32_t side) {
      return Vec3(Eigen::Map<const Eigen::Matrix<Real, 3, 1>>(&s_.corner[6 * std::size_t{side} + 3])
                      .template cast<double>());
    };
    const std::uint32_t patch = next.uints[kContactPatch];
    const Vec3 last = contact_of(cache_, s_, state_).normal;
    for (std::uint32_t side = s_.side_begin[patch]; side < s_.side_begin[patch + 1]; ++side) {
      const std::uint32_t twin = s_.side_twin[side];
      if (twin != kNone && normal_at(twin).dot(last) > normal_at(side).dot(last) + kApart)
        return true;
    }
    return false;
  }

  // The tick ends with the SCP where it was. False once that pushes four times as far as at first.
  bool hold() {
    RawContact<Real> same = state_;
    TrackOptions<Real> options = within(left());
    options.max_iterations = 0;
    const RawHip<Real> hip = raw_hip<Real>(cache_, hip_);
    kernels<Real>().track(s_, t_.options_.method, options, &hip, 1, &same);
    pay_for(same);
    const auto push_of = [&](const auto& raw) { return vector_of(raw, kContactOffset).norm(); };
    if (t_.held_push_ == 0) t_.held_push_ = push_of(state_);
    if (!(push_of(same) <= 4 * t_.held_push_)) return false;
    same.uints[kContactState] = 1;
    same.uints[kContactFlags] &= ~kConverged;
    state_ = same;
    t_.last_ = hip_;
    return true;
  }

  // ... free, whatever the normal at the nearest point says.
  Contact accept_free(RawContact<Real> end) {
    const bool is_behind = is_touching(end);
    end.uints[kContactState] = 0;
    const Contact c = accept(end);
    t_.behind_ = is_behind;
    return c;
  }
  // ... free, though the HIP has not been reached: the next tick goes on from x. A contact that is
  // not known to have ended is held.
  Contact pause(const Vec3& x, double clear, RawContact<Real> end) {
    if (t_.follows() && hold()) return contact(state_);
    end.uints[kContactState] = 0;
    state_ = end;
    t_.last_ = x;
    t_.clear_ = clear;
    return contact(end);
  }

  // Takes a contact that began at x along to the HIP, as slower hands do: where it ends in a thin
  // part depends on the way. As many steps as the tick may spend.
  void follow_way(const Vec3& x, RawContact<Real>& contact) {
    const Vec3 way = hip_ - x;
    const double steps = std::clamp(std::ceil(way.norm() / glide_), 1.0, kWaySteps);
    for (double step = 1; step <= steps; ++step) {
      if (spent_ + options_.max_iterations >= kSearchEvaluations) step = steps;
      const Vec3 to = step < steps ? Vec3(x + step / steps * way) : hip_;
      const RawHip<Real> hip = raw_hip<Real>(cache_, to);
      kernels<Real>().track(s_, t_.options_.method, within(left()), &hip, 1, &contact);
      pay_for(contact);
    }
  }

  // Sphere tracing (Hart 1996) along the way of a free HIP, from last_ to where `end` is the
  // nearest point: the balls round both ends hold no surface, nor does that round any point
  // between. A way that they cover crosses none. `begins_on_it`: the free HIP was on the surface.
  Contact arrive(const RawContact<Real>& end, bool begins_on_it) {
    const Vec3 from = t_.last_, way = hip_ - from;
    const double length = way.norm();
    const bool crosses = is_sure(end) && is_touching(end) != t_.behind_;
    // From where squares overflow nothing is swept.
    const double uncovered =
        std::isfinite(length) ? length - clear_of(end) + (crosses ? on_surface_ : -on_surface_) : 0;
    const auto is_closed = [&](const RawContact<Real>& contact) {
      return cache_.is_closed_at(contact.uints[kContactPatch]);
    };
    bool behind = t_.behind_, glided = begins_on_it, was_near = begins_on_it;
    for (double at = t_.clear_ > 0 ? t_.clear_ : std::min(4 * on_surface_, length);
         at < std::min(uncovered, length);) {
      const Vec3 x = from + (at / length) * way;
      const RawContact<Real> there = nearest(x, kWaySearch);
      const Contact found = contact_of(cache_, s_, there);
      const double clear = clear_of(found);
      const bool is_in = is_touching(there) && !is_unfinished(there), meets = clear <= on_surface_;
      if (!behind && (meets || (is_in && (glided || is_closed(there))))) {
        RawContact<Real> inside = there;
        follow_way(x, inside);
        if (is_touching(inside)) return accept(inside);
      }
      if (!meets) behind = is_in && !is_closed(there);
      // Close to a surface it glides, towards it no farther than to its tangent plane.
      double step = std::min(glide_, length);
      const double towards = (found.scp - x).dot(way) / length;
      if (!meets && towards > 0) step = std::min(step, clear * clear / towards);
      glided = step > clear;
      was_near = was_near || glided || meets;
      step = std::max(step, clear);
      if (spent_ >= kSearchEvaluations || searches_ >= kTickSearches) {
        t_.behind_ = behind;
        return glided ? pause(from + (std::min(at + step, length) / length) * way, 0, end)
                      : pause(x, clear, end);
      }
      at += step;
    }
    if (!is_sure(end)) return pause(hip_, clear_of(end), end);
    // A HIP that was near a surface, or is on it, and ends inside has come in, though its place was
    // not found.
    was_near = was_near || clear_of(end) <= on_surface_;
    return is_closed(end) || (was_near && !behind) ? accept(end) : accept_free(end);
  }

  static constexpr int kDrags = 3;            // ways to where the lag meets the cone
  static constexpr double kConeError = 1e-6;  // at which it does
  static constexpr double kApart = 1e-3;      // of cosines, more than one face's normals differ by
  // Evaluations for a point on the way, where a bound on the distance is enough.
  static constexpr int kWaySearch = 128;
  static constexpr double kWaySteps = 16;

  ContactTracker& t_;
  const PatchCache& cache_;
  const Surface<Real>& s_;
  const TrackOptions<Real> options_;
  RawContact<Real>& state_;
  const Vec3 hip_;
  const double on_surface_;  // closer than this is on it, mesh's unit
  const double glide_;       // longest step that the ball round a point does not cover
  const double rounding_;    // of a place on the surface, mesh's unit
  int spent_ = 0, told_ = 0, searches_ = 0;
  bool is_dragged_ = false;  // the state that the tick ends with has its friction
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
  if (const char* fault = fault_of(options.friction))
    throw std::invalid_argument(std::string("QueryOptions ") + fault);
  if (cache.surface.index() == 1) state_.emplace<1>();
}

Contact ContactTracker::tick(const Vec3& hip) noexcept {
  if (cache_->patch_count() == 0) return no_surface();
  const PlainArithmetic plain;
  return with_surface(
      *cache_, [&]<class Real>(const Surface<Real>& s) { return Tick<Real>(*this, s, hip).run(); });
}

Contact ContactTracker::track(const Vec3& hip, const DomainPoint& start, const Settling* felt,
                              const Friction* friction) noexcept {
  if (cache_->patch_count() == 0) return no_surface();
  const PlainArithmetic plain;
  return with_surface(*cache_, [&]<class Real>(const Surface<Real>& s) {
    Contact contact = Tick<Real>(*this, s, hip).take_over(start, friction);
    if (options_.settle <= 0 || !hip.allFinite()) return contact;
    if (felt == nullptr) {
      felt_.begin(hip, contact);
    } else {
      felt_ = *felt;
      felt_.move(hip, 0);
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
  const double step = std::cbrt(double{std::numeric_limits<Real>::epsilon()}) / cache_->scale *
                      static_cast<double>(s.patch[numbers + kPatchUnscale]);
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
  last_ = hip;
  clear_ = clear;
  behind_ = false;
  felt_.begin_free(hip);
}

void ContactTracker::move_to(const PatchCache& cache) noexcept {
  std::visit(
      [&](auto& state) {
        std::uint32_t& patch = state.uints[kContactPatch];
        state.held_count = 0;
        const std::uint32_t face = cache_->patch_face[patch], first = cache.face_patch[face];
        // Free, the patch is only remembered.
        patch = first == kNone ? 0 : first + (patch - cache_->face_patch[face]);
      },
      state_);
  cache_ = &cache;
}

bool ContactTracker::follows() const {
  return std::visit([](const auto& state) { return state.uints[kContactState] != 0; }, state_);
}

}  // namespace gliss
