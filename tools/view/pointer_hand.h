// A simulated hand that follows what a person points at.
#pragma once

#include "gliss/device/sim_device.h"
#include "gliss/thread/seqlock.h"

namespace gliss::tools {

// A SimDevice whose hand is drawn to the latest target of another thread. What points must go on
// pointing: after kPatience without a word the hand stands still and the device brings nothing new,
// and the guard takes the force away as for any late input.
class PointerHand final : public HapticDevice {
 public:
  static constexpr Nanoseconds kPatience = std::chrono::milliseconds(100);
  // s, in which the hand's will goes 63 % of the way to a target: targets come 60 times a second,
  // and a person's hand is no quicker.
  static constexpr double kEase = 0.015;

  static constexpr double kFastest = 0.1;  // m/s, of a hand that feels its way

  // Rests at `start` until it is drawn, and wants to go no quicker than `fastest` (m/s), however
  // far a target leaps. Throws as SimDevice.
  PointerHand(const Vec3& start, const SimOptions& options = {}, double fastest = kFastest);

  // Draws the hand there. `now` is the loop's clock, monotonic_time(). For one other thread.
  void point(const Vec3& target, Nanoseconds now) noexcept;

  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds now) noexcept override;
  bool write(const Vec3& force, Nanoseconds now) noexcept override {
    return sim_.write(force, now);
  }

 private:
  struct Target {
    double x, y, z;
    std::int64_t when;  // ns
  };
  Seqlock<Target> targets_;
  SimDevice sim_;
  DeviceInfo info_;
  Vec3 will_;  // m, that draws the hand
  double fastest_;
  std::optional<Nanoseconds> last_read_;
  Nanoseconds lived_{0};  // the hand's own time, which stands still while nobody points
  DeviceState state_;     // the last one that was news
};

}  // namespace gliss::tools
