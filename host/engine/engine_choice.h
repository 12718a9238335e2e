// The engine that somebody asks for by words.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gliss/base/poll.h"
#include "gliss/engine/engine.h"
#include "gliss/surface/names.h"

namespace gliss {

inline constexpr Named<const char*> kBackendNames[] = {
    {"tbb", "tbb"}, {"serial", "serial"}, {"opencl", "opencl"}, {"auto", "auto"}};

struct EngineChoice {
  int threads = 0;              // 0: as many as the machine has
  std::string backend = "tbb";  // of kBackendNames
  std::string device;           // of opencl and auto
  int device_memory = 0;        // MiB; 0: as OpenClOptions has it

  // True if a device is asked for, of which the backend has none.
  bool names_device_in_vain() const;
};

// `poll` as Engine has it, `notice` as OpenClOptions has it. Throws std::invalid_argument for
// a device that is named in vain, DeviceError where there is none.
std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const Poll& poll,
                                    const std::function<void(const std::string&)>& notice);

}  // namespace gliss
