// The messages of the Haply Inverse service, port 10001, formats 3.x (docs.haply.co/inverseSDK):
//
//   from it  {"inverse3": [{"device_id": "049D", "state": {"cursor_position": {"x":, "y":, "z":},
//             "cursor_velocity": {...}, ...}, ...}, ...], ...}
//   to it    {"inverse3": [{"device_id": "049D", "commands": {"set_cursor_force": {"vector":
//             {"x":, "y":, "z":}}}}]}
//
// The first message, sent unasked, also has the devices' configuration. Then each message to it is
// answered by one state of all devices.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "gliss/base/vector.h"

namespace gliss {

struct HaplyState {
  std::string device_id;
  Vec3 position, velocity;  // finite; m, m/s
};

// what() goes on from the name of the service: "has no inverse3 among its devices; cure: ...".
struct HaplyProtocolError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Reads the state of the inverse3 with this id, or of the first. The text may be anything; throws
// HaplyProtocolError where it is no such message.
HaplyState read_haply_state(std::string_view text, std::string_view device_id);

// The id is one that read_haply_state() found, the force (N) is finite.
std::string haply_force_command(std::string_view device_id, const Vec3& force);

}  // namespace gliss
