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

std::unique_ptr<HapticDevice> open_scene_device(const std::string& words, const Scene& scene) {
  return gliss::open_device(words, scene,
                            {.name = "--device",
                             .poll = stop_if_interrupted,
                             .open_other = open_haply,
                             .other_words = kHaplyWords});
}

}  // namespace gliss::tools
