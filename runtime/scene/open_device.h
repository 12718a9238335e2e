// The devices that loops run under, by the words that name them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/device/device.h"
#include "gliss/scene/scene.h"

namespace gliss {

// Ways to open what words name.
struct DeviceOpening {
  std::string name = "device";  // that the texts of errors give the words
  Poll poll = nullptr;          // while a file is read
  bool realtime = true;  // a thread of the device's own is scheduled above the scene's priority
  // Opens a device of another library, as open_haply() (gliss/haply/haply_device.h), whose thread
  // has this priority; null where the words name none.
  std::function<std::unique_ptr<HapticDevice>(const std::string& words, int priority)> open_other =
      nullptr;
  std::string other_words{};  // that name those: kHaplyWords
};

// The words that name devices without another library.
inline constexpr char kDeviceWords[] = "sim, replay:FILE, udp:PORT";

// The FILE of replay:FILE; "" for other devices.
GLISS_EXPORT std::string replayed_file(const std::string& words);

// Throws std::invalid_argument where the words or the scene make no sense or a file cannot be
// read, LoopError where the device does not answer.
GLISS_EXPORT std::unique_ptr<HapticDevice> open_device(const std::string& words, const Scene& scene,
                                                       const DeviceOpening& opening = {});

}  // namespace gliss
