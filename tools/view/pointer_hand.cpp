#include "tools/view/pointer_hand.h"

#include <cmath>

namespace gliss::tools {

PointerHand::PointerHand(const Vec3& start, const SimOptions& options)
    : sim_(HandPath({0}, {start}), options), info_(sim_.info()), will_(start) {
  info_.name = "the pointer's hand";
  info_.real_time = true;
  sim_.draw_to(start);
}

void PointerHand::point(const Vec3& target, Nanoseconds now) noexcept {
  if (!target.allFinite()) return;
  targets_.store({target.x(), target.y(), target.z(), now.count()});
}

DeviceState PointerHand::read(Nanoseconds now) noexcept {
  const Nanoseconds passed = last_read_ ? now - *last_read_ : Nanoseconds(0);
  last_read_ = now;
  const auto latest = targets_.load();
  if (!latest || now - Nanoseconds(latest->value.when) > kPatience) return state_;
  const Target& target = latest->value;
  lived_ += passed;
  will_ +=
      (1 - std::exp(-in_seconds(passed) / kEase)) * (Vec3(target.x, target.y, target.z) - will_);
  sim_.draw_to(will_);
  const auto sequence = state_.sequence + 1;
  state_ = sim_.read(lived_);
  state_.sequence = sequence;
  state_.measured = now;
  return state_;
}

}  // namespace gliss::tools
