#include "gliss/device/replay_device.h"

#include <stdexcept>

namespace gliss {

ReplayDevice::ReplayDevice(std::vector<Vec3> positions, const std::string& name,
                           std::vector<Turn> orientations)
    : positions_(std::move(positions)), orientations_(std::move(orientations)) {
  if (!orientations_.empty() && orientations_.size() != positions_.size())
    throw std::invalid_argument("ReplayDevice: not as many orientations as positions");
  info_.name = name;
  info_.real_time = false;
  info_.has_orientation = !orientations_.empty();
}

DeviceState ReplayDevice::read(Nanoseconds now) noexcept {
  DeviceState state;
  state.ended = read_ == positions_.size();
  if (!state.ended) ++read_;
  state.sequence = read_;
  state.measured = now;
  if (read_ > 0) {
    state.position = positions_[read_ - 1];
    if (info_.has_orientation) state.orientation = orientations_[read_ - 1];
  }
  return state;
}

}  // namespace gliss
