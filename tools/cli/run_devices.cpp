#include "tools/cli/run_devices.h"

#include <fmt/format.h>

#include <algorithm>

#include "gliss/device/replay_device.h"
#include "gliss/device/udp_device.h"
#include "gliss/haply/haply_device.h"
#include "gliss/tables/point_table.h"
#include "tools/cli/command_line.h"

namespace gliss::tools {
namespace {

std::unique_ptr<HapticDevice> open_sim(const Scene& scene) {
  if (!scene.sim)
    throw InputError("--device sim: the scene has no [sim] with waypoints, the way of the hand");
  return std::make_unique<SimDevice>(scene.sim_path, *scene.sim);
}

std::unique_ptr<HapticDevice> open_replay(const std::string& file,
                                          const std::function<void()>& poll) {
  try {
    std::vector<std::string> columns = kTurnColumns;
    columns.insert(columns.end(), kMotionColumns.begin(), kMotionColumns.end());
    PointTable path = read_points(file, 1, columns, poll);
    std::vector<Turn> turns = std::move(path.turns);
    std::vector<Vec3> velocities = std::move(path.velocities);
    return std::make_unique<ReplayDevice>(points_in_metres(std::move(path)), "replay:" + file,
                                          std::move(turns), std::move(velocities));
  } catch (const std::runtime_error& error) {  // also where there is no such file
    throw InputError(error.what());
  }
}

std::unique_ptr<HapticDevice> open_haply(const std::string& where, int priority) {
  HaplyOptions options;
  options.priority = priority;
  const auto colon = where.rfind(':');
  if (!where.empty()) options.host = where.substr(0, colon);
  if (colon != std::string::npos)
    options.port = parse_number<std::uint16_t>("--device haply", where.substr(colon + 1));
  return std::make_unique<HaplyDevice>(options);
}

}  // namespace

std::string replayed_file(const std::string& words) {
  constexpr std::string_view kReplay = "replay:";
  return words.starts_with(kReplay) ? words.substr(kReplay.size()) : "";
}

std::unique_ptr<HapticDevice> open_device(const std::string& words, const Scene& scene,
                                          const std::function<void()>& poll, bool realtime) {
  const auto colon = words.find(':');
  const std::string kind = words.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : words.substr(colon + 1);
  if (words == "sim") return open_sim(scene);
  if (!replayed_file(words).empty()) return open_replay(rest, poll);
  if (kind == "udp" && !rest.empty())
    return std::make_unique<UdpDevice>(parse_number<std::uint16_t>("--device udp", rest));
  if (kind == "haply" && (words == kind || !rest.empty()))
    return open_haply(rest, realtime ? std::min(scene.priority + 1, 99) : 0);
  throw InputError(fmt::format("--device: '{}' is not one of {}", words, kDeviceWords));
}

}  // namespace gliss::tools
