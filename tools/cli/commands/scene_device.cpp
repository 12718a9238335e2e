#include "tools/cli/commands/scene_device.h"

#include <fmt/format.h>

#include "gliss/haply/haply_device.h"
#include "tools/cli/terminal/watch.h"

namespace gliss::tools {

void add_device_option(Command& command, std::string& words, const std::string& usual) {
  command.option(
      {"--device", "DEVICE", fmt::format("{}, {}; default: {}", kDeviceWords, kHaplyWords, usual)},
      words);
}

void add_record_option(Command& command, const std::string& does, std::string& path) {
  command.option(
      {"-o,--record", "FILE", fmt::format("{}: .h5, .hdf5 or .csv", does)},
      [&path](const std::string& text) {
        if (!text.ends_with(".csv") && !text.ends_with(".h5") && !text.ends_with(".hdf5"))
          throw InputError(fmt::format("'{}' must end in .h5, .hdf5 or .csv", text));
        path = text;
      });
}

std::unique_ptr<HapticDevice> open_scene_device(const std::string& words, const Scene& scene) {
  return gliss::open_device(words, scene,
                            {.name = "--device",
                             .poll = stop_if_interrupted,
                             .open_other = open_haply,
                             .other_words = kHaplyWords});
}

}  // namespace gliss::tools
