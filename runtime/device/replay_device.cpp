#include "gliss/device/replay_device.h"

namespace gliss {

ReplayDevice::ReplayDevice(std::vector<Vec3> positions, const std::string& name)
    : positions_(std::move(positions)) {
  info_.name = name;
  info_.real_time = false;
}

DeviceState ReplayDevice::read(Nanoseconds now) noexcept {
  DeviceState state;
  state.ended = read_ == positions_.size();
  if (!state.ended) ++read_;
  state.sequence = read_;
  state.measured = now;
  if (read_ > 0) state.position = positions_[read_ - 1];
  return state;
}

}  // namespace gliss
