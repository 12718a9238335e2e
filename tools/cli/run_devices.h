// The devices that gliss run and gliss serve can open, by the words that name them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gliss/device/device.h"
#include "gliss/scene/scene.h"

namespace gliss::tools {

inline constexpr char kDeviceWords[] =
    "sim, replay:FILE, udp:PORT, haply, haply:HOST or haply:HOST:PORT";

// The FILE of replay:FILE; "" for other devices.
std::string replayed_file(const std::string& words);

// Throws InputError where the words or the scene make no sense, LoopError where the device does not
// answer. `poll` is asked many times a second while a file is read, and what it throws ends that.
// `realtime`: a thread of the device's own is scheduled above the scene's priority.
std::unique_ptr<HapticDevice> open_device(const std::string& words, const Scene& scene,
                                          const std::function<void()>& poll, bool realtime = true);

}  // namespace gliss::tools
