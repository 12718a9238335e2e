// The devices that gliss run and gliss serve can open, by the words that name them.
#pragma once

#include <memory>
#include <string>

#include "gliss/device/device.h"
#include "gliss/scene/scene.h"
#include "tools/cli/command.h"

namespace gliss::tools {

inline constexpr char kDeviceWords[] =
    "sim, replay:FILE, udp:PORT, haply, haply:HOST or haply:HOST:PORT";

// The SCENE of a command; a mesh or a cache in its place is refused.
void add_scene_option(Command& command, std::string& scene, const std::string& description);

// Throws InputError where the words or the scene make no sense, LoopError where the device does not
// answer.
std::unique_ptr<HapticDevice> open_device(const std::string& words, const Scene& scene);

}  // namespace gliss::tools
