// The OpenCL engine: the host's kernels on any OpenCL device.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/engine/engine.h"

namespace gliss {

// No device, or one that fails; what() is one line that names it and says why.
struct GLISS_EXPORT DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct OpenClDevice {
  std::string platform, name, driver;
  std::string language;  // OpenCL C version
  std::string type;      // "CPU", "GPU", "accelerator"
  bool fp64 = false;
  bool exact = false;                     // divides and takes roots in float as IEEE says
  bool shares_memory = false;             // with the host
  std::uint64_t memory = 0;               // bytes
  std::uint64_t largest_buffer = 0;       // bytes
  std::uint32_t units = 0;                // compute units
  int lanes_float = 1, lanes_double = 1;  // that evaluation uses on it
};

// All that there are, in the order of their numbers. Throws DeviceError where there is none.
GLISS_EXPORT std::vector<OpenClDevice> opencl_devices();

struct OpenClOptions {
  // Part of the name of a device or platform, or a device's number; empty: the first GPU, else the
  // first device.
  std::string device;
  std::uint64_t memory = 0;           // bytes to use on the device at most; 0: half of what it has
  std::size_t smallest_batch = 2048;  // fewer points or HIPs than this are done on the host
  int threads = 0;                    // of the host, 0: as many as the machine has
  // The host does what the device fails to do, and all where no GPU is found and none is named.
  bool fall_back = false;
  // Lines for the user: that kernels are compiled, that the host takes over.
  std::function<void(const std::string&)> notice = nullptr;
  Poll poll = {};  // as of Engine
};

// Throws DeviceError where there is no such device; with options.fall_back the engine is oneTBB's
// then. A cache in double needs a device with fp64.
GLISS_EXPORT std::unique_ptr<Engine> make_opencl_engine(const OpenClOptions& options = {});

}  // namespace gliss
