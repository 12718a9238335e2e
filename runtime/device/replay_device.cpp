#include "gliss/device/replay_device.h"

#include <stdexcept>

namespace gliss {

ReplayDevice::ReplayDevice(std::vector<Vec3> positions, const std::string& name,
                           std::vector<Rotation> orientations, std::vector<Vec3> velocities)
    : positions_(std::move(positions)),
      orientations_(std::move(orientations)),
      velocities_(std::move(velocities)) {
  if (!orientations_.empty() && orientations_.size() != positions_.size())
    throw std::invalid_argument("ReplayDevice: not as many orientations as positions");
  if (!velocities_.empty() && velocities_.size() != positions_.size())
    throw std::invalid_argument("ReplayDevice: not as many velocities as positions");
  info_.name = name;
  info_.real_time = false;
  info_.has_orientation = !orientations_.empty();
  info_.has_velocity = !velocities_.empty();
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
    if (info_.has_velocity && !state.ended) state.velocity = velocities_[read_ - 1];
  }
  return state;
}

}  // namespace gliss
