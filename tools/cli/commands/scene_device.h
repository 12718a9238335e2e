// The devices of gliss run and gliss serve.
#pragma once

#include <memory>
#include <string>

#include "gliss/scene/open_device.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

// `usual`: the device where nobody names one, for the help.
void add_device_option(Command& command, std::string& words, const std::string& usual = "sim");
// Throws std::invalid_argument, LoopError, Interrupted.
std::unique_ptr<HapticDevice> open_scene_device(const std::string& words, const Scene& scene);

}  // namespace gliss::tools
