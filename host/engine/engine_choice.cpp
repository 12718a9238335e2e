#include "gliss/engine/engine_choice.h"

#include <stdexcept>

#include "gliss/engine/opencl.h"

namespace gliss {

bool EngineChoice::names_device_in_vain() const {
  return backend != "opencl" && backend != "auto" && (!device.empty() || device_memory > 0);
}

std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const Poll& poll,
                                    const std::function<void(const std::string&)>& notice) {
  if (choice.names_device_in_vain())
    throw std::invalid_argument("an OpenCL device is for the backends opencl and auto");
  if (choice.backend == "serial") return make_serial_engine(poll);
  if (choice.backend == "tbb") return make_tbb_engine(choice.threads, poll);
  OpenClOptions opencl;
  opencl.device = choice.device;
  opencl.memory = static_cast<std::uint64_t>(choice.device_memory) << 20;
  opencl.threads = choice.threads;
  opencl.poll = poll;
  opencl.fall_back = choice.backend == "auto";
  opencl.notice = notice;
  return make_opencl_engine(opencl);
}

}  // namespace gliss
