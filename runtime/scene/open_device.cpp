#include "gliss/scene/open_device.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

#include "gliss/device/port.h"
#include "gliss/device/replay_device.h"
#include "gliss/device/udp_device.h"
#include "gliss/tables/point_table.h"

namespace gliss {
namespace {

std::unique_ptr<HapticDevice> open_sim(const Scene& scene, const DeviceOpening& opening) {
  if (!scene.sim)
    throw std::invalid_argument(fmt::format(
        "{} sim: the scene has no [sim] with waypoints, the way of the hand", opening.name));
  return std::make_unique<SimDevice>(scene.sim_path, *scene.sim);
}

std::unique_ptr<HapticDevice> open_replay(const std::string& file, const Poll& poll) {
  try {
    std::vector<std::string> columns = kRotationColumns;
    columns.insert(columns.end(), kMotionColumns.begin(), kMotionColumns.end());
    PointTable path = read_points(file, 1, columns, poll);
    std::vector<Rotation> rotations = std::move(path.rotations);
    std::vector<Vec3> velocities = std::move(path.velocities);
    return std::make_unique<ReplayDevice>(points_in_metres(std::move(path)), "replay:" + file,
                                          std::move(rotations), std::move(velocities));
  } catch (const std::runtime_error& error) {  // also where there is no such file
    throw std::invalid_argument(error.what());
  }
}

// Null where there is no such device.
std::unique_ptr<HapticDevice> open_other(const std::string& words, const Scene& scene,
                                         const DeviceOpening& opening) {
  if (!opening.open_other) return nullptr;
  try {
    return opening.open_other(words, opening.realtime ? scene.priority + 1 : 0);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(fmt::format("{} {}", opening.name, error.what()));
  }
}

}  // namespace

std::string replayed_file(const std::string& words) {
  constexpr std::string_view kReplay = "replay:";
  return words.starts_with(kReplay) ? words.substr(kReplay.size()) : "";
}

std::unique_ptr<HapticDevice> open_device(const std::string& words, const Scene& scene,
                                          const DeviceOpening& opening) {
  constexpr std::string_view kUdp = "udp:";
  if (words == "sim") return open_sim(scene, opening);
  if (const auto file = replayed_file(words); !file.empty()) return open_replay(file, opening.poll);
  if (words.starts_with(kUdp) && words != kUdp)
    return std::make_unique<UdpDevice>(
        detail::parse_port(opening.name + " udp", words.substr(kUdp.size())));
  if (auto device = open_other(words, scene, opening)) return device;
  throw std::invalid_argument(fmt::format("{}: '{}' is not one of {}{}{}", opening.name, words,
                                          kDeviceWords, opening.other_words.empty() ? "" : ", ",
                                          opening.other_words));
}

}  // namespace gliss
