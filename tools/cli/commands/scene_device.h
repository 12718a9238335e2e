// The devices and the recordings of commands that run a loop.
#pragma once

#include <memory>
#include <string>

#include "gliss/scene/open_device.h"
#include "tools/cli/words/command.h"

namespace gliss::tools {

// `usual`: the device where nobody names one, for the help.
void add_device_option(Command& command, std::string& words, const std::string& usual = "sim");
// -o and --record; `does` says for the help what it does.
void add_record_option(Command& command, const std::string& does, std::string& path);
// Throws std::invalid_argument, LoopError, Interrupted.
std::unique_ptr<HapticDevice> open_scene_device(const std::string& words, const Scene& scene);

}  // namespace gliss::tools
