// A recorded path of positions, one a tick, as a device. Its forces go nowhere.
#pragma once

#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/device/device.h"

namespace gliss {

class GLISS_EXPORT ReplayDevice final : public HapticDevice {
 public:
  explicit ReplayDevice(std::vector<Vec3> positions, const std::string& name = "replay");

  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds now) noexcept override;
  bool write(const Vec3&, Nanoseconds) noexcept override { return true; }

 private:
  DeviceInfo info_;
  std::vector<Vec3> positions_;  // m
  std::size_t read_ = 0;
};

}  // namespace gliss
