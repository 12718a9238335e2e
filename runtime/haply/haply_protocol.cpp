#include "gliss/haply/haply_protocol.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace gliss {
namespace {

using Json = nlohmann::json;

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

// A short line, whatever is in it.
std::string in_quotes(std::string_view text) {
  return Json(text.substr(0, 40)).dump(-1, ' ', true, Json::error_handler_t::replace);
}

const Json kNull;

// Null where it is no object or has no such key.
const Json& member(const Json& object, const char* key) {
  const auto found = object.find(key);  // end() for what is no object
  return found == object.end() ? kNull : *found;
}

Vec3 vector_of(const Json& state, const char* key) {
  const Json& vector = member(state, key);
  Vec3 result;
  for (int i = 0; i < 3; ++i) {
    const Json& number = member(vector, kAxes[static_cast<std::size_t>(i)]);
    result[i] = number.is_number() ? number.get<double>() : std::nan("");
  }
  if (!result.allFinite()) {
    throw HaplyProtocolError(fmt::format(
        "answered with a state whose {} is not three finite numbers; cure: a service with formats "
        "3.x, version 3.1 or later",
        key));
  }
  return result;
}

std::string id_of(const Json& device) {
  const Json& id = member(device, "device_id");
  return id.is_string() ? id.get<std::string>() : "";
}

const Json& device_of(const Json& devices, std::string_view device_id) {
  std::string others;
  for (const Json& device : devices.is_array() ? devices : kNull) {
    const std::string id = id_of(device);
    if (id.empty()) continue;
    if (device_id.empty() || id == device_id) return device;
    if (others.size() < 100) others += (others.empty() ? "" : ", ") + in_quotes(id);
  }
  if (others.empty()) {
    throw HaplyProtocolError(
        "has no inverse3 among its devices; cure: connect one, and see that the service finds it");
  }
  throw HaplyProtocolError(
      fmt::format("has no inverse3 {} among its devices; cure: a device_id that it has: {}",
                  in_quotes(device_id), others));
}

}  // namespace

HaplyState read_haply_state(std::string_view text, std::string_view device_id) {
  const Json message = Json::parse(text, nullptr, false);
  if (message.is_discarded()) {
    throw HaplyProtocolError(
        "answered with something that is not JSON; cure: the host and port of a Haply Inverse "
        "service");
  }
  const Json& device = device_of(member(message, "inverse3"), device_id);
  const Json& state = member(device, "state");
  return {id_of(device), vector_of(state, "cursor_position"), vector_of(state, "cursor_velocity")};
}

std::string haply_force_command(std::string_view device_id, const Vec3& force) {
  const Json vector{{"x", force.x()}, {"y", force.y()}, {"z", force.z()}};
  const Json device{{"device_id", device_id},
                    {"commands", {{"set_cursor_force", {{"vector", vector}}}}}};
  return Json{{"inverse3", Json::array({device})}}.dump();
}

}  // namespace gliss
