// Measures what a device can do at most: what the engine's kernels are compared with.
#pragma once

#include <string>

namespace gliss::bench {

struct DevicePeak {
  double operations = 0;  // of float a second, an fma being two
  double bandwidth = 0;   // bytes read and written a second
};

// Measures the device that OpenClOptions::device names.
DevicePeak measure_peak(const std::string& device);

}  // namespace gliss::bench
