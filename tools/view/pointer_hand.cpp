#include "tools/view/pointer_hand.h"

#include <algorithm>
#include <cmath>

namespace gliss::tools {

PointerHand::PointerHand(const Vec3& start, const SimOptions& options, double fastest)
    : sim_(HandPath({0}, {start}), options), info_(sim_.info()), will_(start), fastest_(fastest) {
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
  const Vec3 way = Vec3(target.x, target.y, target.z) - will_;
  const double most = fastest_ * in_seconds(passed), length = way.norm(),
               eased = (1 - std::exp(-in_seconds(passed) / kEase)) * length;
  if (length > 0) will_ += std::min(eased, most) / length * way;
  sim_.draw_to(will_);
  const auto sequence = state_.sequence + 1;
  state_ = sim_.read(lived_);
  state_.sequence = sequence;
  state_.measured = now;
  return state_;
}

}  // namespace gliss::tools
