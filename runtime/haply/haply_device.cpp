#include "gliss/haply/haply_device.h"

#include <stdexcept>
#include <string_view>

#include "gliss/device/guard.h"
#include "gliss/device/port.h"
#include "gliss/haply/haply_link.h"

namespace gliss {

HaplyDevice::HaplyDevice(const HaplyOptions& options) {
  if (options.connect_timeout <= Nanoseconds(0) || options.connect_timeout > std::chrono::hours(1))
    throw std::invalid_argument("haply: the time to connect in must be over 0 and at most 1 h");
  if (!(options.max_force > 0) || !(options.max_stiffness > 0))
    throw std::invalid_argument("haply: the largest force and stiffness must be positive");
  if (options.priority < 0 || options.priority > 99)
    throw std::invalid_argument(
        "haply: the priority of its thread must be 1 to 99, and above the loop's, so that the "
        "loop's is at most 98; or 0 for none");
  link_ = std::make_unique<HaplyLink>(options);
  info_.name = "haply:" + link_->device_id();
  info_.max_force = options.max_force;
  info_.max_stiffness = options.max_stiffness;
  info_.workspace = options.workspace;
  info_.has_velocity = true;
}

HaplyDevice::~HaplyDevice() = default;

DeviceState HaplyDevice::read(Nanoseconds) noexcept {
  if (const auto sample = link_->states.load()) {
    const HaplyMeasured& now = sample->value;
    last_.sequence = now.sequence;
    last_.measured = now.time;
    last_.position = now.position.value();
    last_.velocity = now.velocity.value();
    last_.fault = now.fault;
  }
  return last_;
}

bool HaplyDevice::write(const Vec3& force, Nanoseconds now) noexcept {
  const auto given = motor_force(force, info_.max_force);
  link_->forces.store({HaplyVector::of(given.value_or(Vec3::Zero())), now});
  return given && !link_->failed.load(std::memory_order_relaxed);
}

std::uint64_t HaplyDevice::malformed() const noexcept {
  return link_->malformed.load(std::memory_order_relaxed);
}

std::vector<std::string> HaplyDevice::refusals() const {
  if (link_->refused().empty()) return {};
  return {"haply's thread: " + link_->refused()};
}

std::unique_ptr<HapticDevice> open_haply(const std::string& words, int priority) {
  constexpr std::string_view kBegin = "haply:";
  HaplyOptions options;
  options.priority = priority;
  if (words == "haply") return std::make_unique<HaplyDevice>(options);
  if (!words.starts_with(kBegin) || words == kBegin) return nullptr;
  const std::string where = words.substr(kBegin.size());
  const auto colon = where.rfind(':');
  options.host = where.substr(0, colon);
  if (colon != where.npos) options.port = detail::parse_port("haply", where.substr(colon + 1));
  return std::make_unique<HaplyDevice>(options);
}

}  // namespace gliss
