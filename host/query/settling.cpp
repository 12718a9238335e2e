#include "gliss/query/settling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/query/force_statistics.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

// Where HIPs go by 1 % of their depth in a tick, as in walks, a jump is 20 ways of the HIP. The way
// and a stride are 9 of them. A hand at rest has a share that is as much at 64 depths.
constexpr double kWays = 8, kStillShare = 1.0 / 32;
// The error of a force that is held for a tick, over the way squared: half of the largest
// curvature of the energy, which is 1, and 5 / 3 on a rim (kernels/contact.h, past_border).
constexpr double kError = 1.0 / 2, kRimError = 5.0 / 6;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();  // of energy

bool is_guess(const Contact& contact) { return (contact.flags & kUnfinished) != 0; }
bool is_rim(const Contact& contact) { return (contact.flags & kOnBorder) != 0; }

void settle_at(const Vec3& push, Contact& now) {
  now.push = push + Vec3::Zero();  // without -0
  now.touching = true;
  now.flags |= kSettling;
}

}  // namespace

Settling::Settling(double settle, double tiny) : settle_(settle), tiny_(tiny) {}

void Settling::begin(const Vec3& hip, const Contact& contact) noexcept {
  begin_free(hip);
  if (!contact.push.allFinite()) return;
  felt_ = contact.push;
  energy_ = energy_of(contact);
}

void Settling::begin_free(const Vec3& hip) noexcept {
  hip_ = hip;
  felt_.setZero();
  energy_ = fading_ = 0;
  is_short_ = false;
}

void Settling::move(const Vec3& hip, double clear, double dt) noexcept {
  way_ = hip - hip_;
  hip_ = hip;
  dt_ = dt;
  pace_ = std::max(0.0, way_.norm() - std::max(0.0, clear));
  allowed_ = 0;
}

double Settling::share(double size) const {
  return std::min(1.0, ForceStatistics::kJump * dt_ / settle_) * size;
}

double Settling::stride(double size) const {
  return std::min(share(size), std::max(kWays * pace_, kStillShare * share(size)));
}

double Settling::stride_to(const Vec3& to) const {
  const double least = std::min(felt_.norm(), to.norm());
  return stride(least > 0 ? least : 0.5 * (felt_ + to).norm());
}

bool Settling::is_leap(const Vec3& to) const {
  const double change2 = (to - felt_).squaredNorm(), least = 2 * pace_ + allowed_;
  if (change2 <= least * least) return false;
  return std::sqrt(change2) > pace_ + allowed_ + std::max(pace_, stride_to(to));
}

double Settling::energy_of(const Contact& contact) const {
  if (!contact.touching) return 0;
  const bool has_potential = is_rim(contact) && !is_settling(contact.flags);
  return 0.5 * (has_potential ? contact.push.dot(contact.scp - hip_) : contact.push.squaredNorm());
}

// The energy that there may be now. One who goes out of what he has not paid for gets no error.
double Settling::paid(const Contact& now) const {
  const double error = is_rim(now) ? kRimError : kError;
  const bool goes_out = is_short_ && way_.dot(now.push) > 0;
  return energy_ - felt_.dot(way_) + (goes_out ? 0 : error * pace_ * pace_);
}

void Settling::feel(Contact& now, bool has_energy) noexcept {
  if (!now.push.allFinite()) return begin_free(hip_);
  const double wanted = energy_of(now);
  const double most = has_energy ? paid(now) : kUnbounded, available = std::max(0.0, most);
  is_short_ = wanted > available && wanted > available + tiny_ * now.push.norm();
  if (is_short_) settle_at(std::sqrt(available / wanted) * now.push, now);
  if (!is_leap(now.push)) {
    fading_ = 0;
  } else if (now.touching) {
    fading_ = 0;
    turn(now, most);
  } else {
    fade(now);
  }
  felt_ = now.push;
  // The energy that a straight way saves is lost; all is kept until a search has ended.
  energy_ = std::min(most, is_guess(now) ? kUnbounded : energy_of(now));
}

// The contact point is held while the HIP moves, and comes as near as the energy asks. Then the
// push turns to where it belongs, as far as it may change, its size going evenly from the one to
// the other: it gives no energy that it would have to take back. One that is about opposite goes
// straight.
void Settling::turn(Contact& now, double most) const {
  const double length = stride_to(now.push), largest = std::sqrt(2 * std::max(0.0, most));
  Vec3 push = felt_.isZero(0) ? felt_ : Vec3(felt_ - way_);
  const double over = push.norm() - largest;
  if (over > 0) push *= 1 - std::min(over, length) / push.norm();
  // |gone + share left| = change
  const Vec3 gone = push - felt_, left = now.push - push;
  const double change = pace_ + length, slope = gone.dot(left), size2 = left.squaredNorm();
  const double room = slope * slope + size2 * (change * change - gone.squaredNorm());
  const double share = std::clamp((std::sqrt(std::max(0.0, room)) - slope) / size2, 0.0, 1.0);
  const double from = push.norm(), to = now.push.norm();
  Vec3 turned = push + share * left;
  if (push.dot(now.push) > -0.5 * from * to) turned *= (from + share * (to - from)) / turned.norm();
  settle_at(turned, now);
}

// The push of a contact that has ended keeps its direction: there is no place to pull the HIP
// back to. It grows no more, and along its way out it pays for the work that it does.
void Settling::fade(Contact& now) {
  const double size = felt_.norm(), work = std::max(0.0, felt_.dot(way_));
  fading_ = std::max(fading_, size);
  const double length = way_.norm() + share(fading_);
  const double left = std::min(size - length, std::sqrt(std::max(0.0, size * size - 2 * work)));
  if (left > 0) settle_at(left / size * felt_, now);
}

}  // namespace gliss
