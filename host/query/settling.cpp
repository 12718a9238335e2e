#include "gliss/query/settling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/query/force_statistics.h"
#include "gliss/surface/instances.h"

namespace gliss {
namespace {

// Where HIPs go by 1 % of their depth in a tick, as in walks, a jump is 20 ways of the HIP. Twice
// the way and a stride are 10 of them. A hand at rest has a share that is as much at 64 depths.
constexpr double kWays = 8, kAtRest = 1.0 / 32;
// The error of a force that is held for a tick, over the way squared: half of the largest
// curvature of the energy, which is 1, and 5 / 3 on a rim (kernels/contact.h, past_border).
constexpr double kError = 1.0 / 2, kRimError = 5.0 / 6;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();  // of energy

bool is_guess(const Contact& contact) { return (contact.flags & kUnfinished) != 0; }
bool is_rim(const Contact& contact) { return (contact.flags & kOnBorder) != 0; }

void settle_at(const Vec3& push, Contact& now) {
  now.push = push;
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
  dt_ = dt;
  way_ = hip - hip_;
  hip_ = hip;
  pace_ = std::max(0.0, way_.norm() - std::max(0.0, clear));
  allowed_ = 0;
}

double Settling::stride(double size, double way) const {
  const double share = std::min(1.0, ForceStatistics::kJump * dt_ / settle_) * size;
  return std::min(share, std::max(kWays * way, kAtRest * share));
}

// The share is of their mean where one of the two is none.
double Settling::reach(const Vec3& from, const Vec3& to) const {
  const double least = std::min(from.norm(), to.norm());
  return pace_ + stride(least > 0 ? least : 0.5 * (from + to).norm(), pace_);
}

bool Settling::is_leap(const Vec3& from, const Vec3& to) const {
  const double change2 = (to - from).squaredNorm(), least = 2 * pace_ + allowed_;
  if (change2 <= least * least) return false;
  return std::sqrt(change2) > pace_ + allowed_ + reach(from, to);
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
    go_straight(now, most);
  } else {
    fade(now);
  }
  felt_ = now.push;
  // Energy that a straight way saves is kept for its end, and all until a search has ended.
  energy_ = std::min(most, is_guess(now) ? kUnbounded : std::max(energy_of(now), wanted));
}

// The contact point is held while the HIP moves, comes as near as the energy asks, and then goes
// straight to where it belongs.
void Settling::go_straight(Contact& now, double most) const {
  Vec3 push = felt_.isZero(0) ? felt_ : Vec3(felt_ - way_);
  double length = reach(felt_, now.push);
  const double size = push.norm(), over = size - std::sqrt(2 * std::max(0.0, most));
  if (over > 0) {
    const double cut = std::min(over, length);
    push *= 1 - cut / size;
    length -= cut;
  }
  const Vec3 left = now.push - push;
  settle_at(push + std::min(1.0, length / left.norm()) * left, now);
}

// The push of a contact that has ended keeps its direction, for there is no place to pull the HIP
// back to. It grows no more, and along its way out it pays for the work that it does.
void Settling::fade(Contact& now) {
  const double size = felt_.norm(), work = std::max(0.0, felt_.dot(way_)), way = way_.norm();
  fading_ = std::max(fading_, size);
  const double length = way + stride(fading_, way);
  const double left = std::min(size - length, std::sqrt(std::max(0.0, size * size - 2 * work)));
  if (left > 0) settle_at(left / size * felt_, now);
}

}  // namespace gliss
