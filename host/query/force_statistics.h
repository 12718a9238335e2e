// Counts how a series of forces, one a tick, feels: its steps, its jumps and the contacts that it
// loses.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"

namespace gliss {

// The force of a free tick is zero. A tick in contact, or just after contact, has a step:
// |F_i - F_(i-1)|. So gaining contact is a step from zero, and losing contact is a step to zero.
// The first tick of a series has no step.
//
// A jump is a tick whose step is above 20 % of the full force, a gain of contact included. A lost
// contact is one that ends under more than 20 % of the full force. It is among the jumps.
//
// The full force is k d, stiffness times depth, where the depth d is known. Elsewhere it is the
// force held lately: in each tick in contact the larger of |F| and 0.99 of what it was. At constant
// depth that is k d. The first ten ticks of a contact wait for each other, and all are judged by
// the force held at their end: so pressing in smoothly is no jump.
//
// A tick whose step is not finite is unsound. It counts as a jump, makes `largest_step` infinite,
// and is left out of all else.
struct GLISS_EXPORT ForceStatistics {
  static constexpr double kJump = 0.2;  // of the full force
  static constexpr double kHeld = 0.99;
  static constexpr std::uint32_t kEntry = 10;  // ticks of a contact that are judged together

  double largest_step = 0, mean_step = 0;  // N
  double largest_force = 0;                // N
  std::uint64_t ticks = 0, touching = 0;   // touching: in contact
  std::uint64_t entries = 0;               // from free to contact
  std::uint64_t settling = 0;              // ticks in contact that were on their way (kSettling)
  std::uint64_t lost = 0, unsound = 0;

  ForceStatistics() = default;
  // `full_force`: k d in the unit of the forces; 0: unknown.
  explicit ForceStatistics(double full_force) : known_full_force_(full_force) {}

  // Takes the next tick; force in N; is_settling: its contact has kSettling. Returns its step: NaN
  // where it has none, infinity where it is unsound.
  double add(bool in_contact, const Vec3& force, bool is_settling = false) noexcept {
    const bool has_step = ticks > 0 && (in_contact || was_in_contact_);
    ++ticks;
    touching += in_contact;
    settling += is_settling;
    const double size = force.norm(), step = has_step ? (force - last_).norm() : 0;
    if (!std::isfinite(size) || !std::isfinite(step)) return add_unsound();
    if (in_contact && !was_in_contact_) begin_contact();
    if (in_contact) held_ = std::max(size, kHeld * held_);
    if (!in_contact && was_in_contact_) end_contact();
    largest_force = std::max(largest_force, size);
    if (has_step) count_step(step, in_contact);
    if (in_contact && ++contact_ticks_ == kEntry) judge_entry();
    was_in_contact_ = in_contact;
    last_ = force;
    return has_step ? step : std::numeric_limits<double>::quiet_NaN();
  }

  // Adds what another, complete series felt.
  void merge(const ForceStatistics& other) noexcept {
    largest_step = std::max(largest_step, other.largest_step);
    largest_force = std::max(largest_force, other.largest_force);
    ticks += other.ticks;
    touching += other.touching;
    entries += other.entries;
    settling += other.settling;
    lost += other.lost;
    unsound += other.unsound;
    jumps_ += other.jumps();
    steps_ += other.steps_;
    steps_sum_ += other.steps_sum_;
    if (steps_ > 0) mean_step = steps_sum_ / static_cast<double>(steps_);
  }

  std::uint64_t jumps() const noexcept { return jumps_ + waiting_jumps(); }
  // Per 100,000 ticks in contact; 0 where there was no contact.
  double jumps_per_100k() const noexcept { return per_100k(static_cast<double>(jumps())); }
  double lost_per_100k() const noexcept { return per_100k(static_cast<double>(lost)); }
  // The share of the ticks in contact that settle; 0 where there was none.
  double settling_share() const noexcept { return per_100k(static_cast<double>(settling)) * 1e-5; }

 protected:
  // 0 where there was no contact.
  double per_100k(double count) const noexcept {
    return touching == 0 ? 0 : 1e5 * count / static_cast<double>(touching);
  }

 private:
  double add_unsound() noexcept {
    ++unsound;
    ++jumps_;
    return largest_step = std::numeric_limits<double>::infinity();
  }
  void begin_contact() noexcept {
    ++entries;
    contact_ticks_ = 0;
  }
  void end_contact() noexcept {
    judge_entry();
    lost += last_.norm() > kJump * full_force();
  }
  void count_step(double step, bool in_contact) noexcept {
    largest_step = std::max(largest_step, step);
    steps_sum_ += step;
    mean_step = steps_sum_ / static_cast<double>(++steps_);
    if (known_full_force_ <= 0 && in_contact && contact_ticks_ < kEntry) {
      waiting_[waiting_count_++] = step;
    } else {
      jumps_ += step > kJump * full_force();
    }
  }
  void judge_entry() noexcept {
    jumps_ += waiting_jumps();
    waiting_count_ = 0;
  }
  std::uint64_t waiting_jumps() const noexcept {
    std::uint64_t count = 0;
    for (std::uint32_t i = 0; i < waiting_count_; ++i) count += waiting_[i] > kJump * held_;
    return count;
  }
  double full_force() const noexcept { return known_full_force_ > 0 ? known_full_force_ : held_; }
  double known_full_force_ = 0;
  bool was_in_contact_ = false;
  Vec3 last_ = Vec3::Zero();
  double held_ = 0, steps_sum_ = 0;
  std::uint64_t steps_ = 0, jumps_ = 0;
  std::uint32_t contact_ticks_ = 0, waiting_count_ = 0;
  double waiting_[kEntry] = {};  // steps of this contact's first ticks
};

}  // namespace gliss
