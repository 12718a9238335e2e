// What a device can do at most, measured: what the engine's kernels are compared with.
#pragma once

#include <string>

namespace gliss::bench {

struct DevicePeak {
  double operations = 0;  // of float a second, an fma being two
  double bandwidth = 0;   // bytes read and written a second
};

// Of the device that OpenClOptions::device names.
DevicePeak measure_peak(const std::string& device);

}  // namespace gliss::bench
