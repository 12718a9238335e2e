#include "tools/cli/commands/run_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/words/timing_text.h"

namespace gliss::tools {
namespace {

Json json_of(const Vec3& v) {
  Json list = Json::array();
  for (const double x : v) list.push_back(number(x));
  return list;
}

Json json_of(const LoopTick& tick) {
  return {{"tick", tick.number},
          {"lateness_us", microseconds(tick.lateness)},
          {"compute_us", microseconds(tick.compute)},
          {"missed", tick.missed},
          {"age_us", microseconds(tick.age)},
          {"position_m", json_of(tick.input.position)},
          {"rendered_N", json_of(tick.rendered)},
          {"sent_N", json_of(tick.sent)},
          {"guard", guard_state_name(tick.state)},
          {"reason", guard_reason_name(tick.reason)}};
}

}  // namespace

void RunReport::add(const LoopTick& tick) {
  if (tick.number == 0) begins_inside_ = tick.touching;
  if (tick.rendered.allFinite())
    rendered_.add(tick.touching, tick.rendered, is_settling(tick.flags));
  sent_.add(tick.sent != Vec3::Zero(), tick.sent);
  largest_torque_ = std::max(largest_torque_, tick.sent_torque.norm());
  if (tick.touching && tick.object != LoopTick::kNothing) {
    if (deepest_.size() <= tick.object) deepest_.resize(tick.object + 1, 0);
    deepest_[tick.object] = std::max(deepest_[tick.object], -tick.distance);
  }
  const bool was_safe = !last_.empty() && last_.back().state == GuardState::kSafe;
  if (last_.size() == kTripTicks) last_.pop_front();
  last_.push_back(tick);
  const bool trips = tick.state == GuardState::kSafe && !was_safe && is_failure(tick.reason);
  if (trips && trips_.size() < kTrips) trips_.push_back({tick.reason, last_});
  compute_.add(tick.compute);
  missed_ += tick.missed;
}

std::string RunReport::live_line() {
  if (last_.empty()) return "waiting for the first tick";
  const LoopTick& tick = last_.back();
  const double passed = in_seconds(tick.time - line_at_);
  const double rate = passed > 0 ? static_cast<double>(compute_.count()) / passed : 0;
  const std::string depth = tick.touching ? fmt::format("{:.2f} mm", -1e3 * tick.distance) : "free";
  std::string line = fmt::format(
      "{:6.1f} s  {:6.1f} Hz  depth {:>8}  force {:5.2f} N  missed {}  p99 {:.1f} us  {}",
      in_seconds(tick.time), rate, depth, tick.sent.norm(), missed_,
      microseconds(compute_.quantile(0.99)), guard_state_name(tick.state));
  if (tick.reason != GuardReason::kNone)
    line += fmt::format(": {}", guard_reason_name(tick.reason));
  compute_ = {};
  line_at_ = tick.time;
  return line;
}

Json RunReport::trips_json() const {
  Json trips = Json::array();
  for (const Trip& trip : trips_) {
    Json ticks = Json::array();
    for (const LoopTick& tick : trip.ticks) ticks.push_back(json_of(tick));
    trips.push_back({{"reason", guard_reason_name(trip.reason)}, {"ticks", ticks}});
  }
  return trips;
}

}  // namespace gliss::tools
