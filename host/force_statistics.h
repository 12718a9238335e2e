// What a series of forces, one a tick, felt like.
#pragma once

#include <algorithm>
#include <cstdint>

#include "host/mesh.h"

namespace gliss {

struct ForceStatistics {
  double largest_step = 0,
         mean_step = 0;      // |F_i - F_(i-1)|, N, over ticks where both are in contact
  double largest_force = 0;  // N
  std::uint64_t ticks = 0, touching = 0, entries = 0;  // entries: free to contact

  // The next tick; force in N.
  void add(bool in_contact, const Vec3& force) noexcept {
    ++ticks;
    touching += in_contact;
    entries += in_contact && !was_in_contact_;
    largest_force = std::max(largest_force, force.norm());
    if (in_contact && was_in_contact_) {
      const double step = (force - last_).norm();
      largest_step = std::max(largest_step, step);
      steps_sum_ += step;
      mean_step = steps_sum_ / static_cast<double>(++steps_);
    }
    was_in_contact_ = in_contact;
    last_ = force;
  }

 private:
  bool was_in_contact_ = false;
  Vec3 last_ = Vec3::Zero();
  double steps_sum_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace gliss
