// A recorded path of positions, one a tick, perhaps with orientations and velocities, as a device.
// Its forces go nowhere.
#pragma once

#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/device/device.h"

namespace gliss {

class GLISS_EXPORT ReplayDevice final : public HapticDevice {
 public:
  // Orientations and velocities (m/s): none, or as many as positions, or std::invalid_argument.
  explicit ReplayDevice(std::vector<Vec3> positions, const std::string& name = "replay",
                        std::vector<Rotation> orientations = {}, std::vector<Vec3> velocities = {});

  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds now) noexcept override;
  bool write(const Vec3&, Nanoseconds) noexcept override { return true; }

 private:
  DeviceInfo info_;
  std::vector<Vec3> positions_;  // m
  std::vector<Rotation> orientations_;
  std::vector<Vec3> velocities_;
  std::size_t read_ = 0;
};

}  // namespace gliss
