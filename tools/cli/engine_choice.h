// The engine that somebody asks for by words.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gliss/engine/engine.h"
#include "gliss/surface/names.h"
#include "tools/cli/command_line.h"

namespace gliss::tools {

inline constexpr Named<const char*> kBackendNames[] = {
    {"tbb", "tbb"}, {"serial", "serial"}, {"opencl", "opencl"}, {"auto", "auto"}};

struct EngineChoice {
  int threads = 0;              // 0: as many as the machine has
  std::string backend = "tbb";  // of kBackendNames
  std::string device;           // of opencl and auto
  int device_memory = 0;        // MiB; 0: as OpenClOptions has it
};

// `poll` as Engine has it, `notice` as OpenClOptions has it. Throws InputError for a device that no
// backend asks for, DeviceError where there is none.
std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const std::function<void()>& poll,
                                    const std::function<void(const std::string&)>& notice);

// Throws InputError that lists the names where `wanted` is none of them.
template <class Value, std::size_t count>
Value parse_name(const std::string& option, const std::string& wanted,
                 const Named<Value> (&names)[count]) {
  if (const auto value = find_named(names, wanted)) return *value;
  throw InputError(option + ": '" + wanted + "' is not one of " + listed(names));
}

}  // namespace gliss::tools
