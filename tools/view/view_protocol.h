// The words between gliss view and its page. All that a browser sends goes through these pure
// functions: they take any bytes, and say what is to be done with them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "gliss/query/friction.h"
#include "gliss/query/texture.h"
#include "gliss/surface/names.h"

namespace gliss::tools {

inline constexpr std::size_t kLongestHead = 8 << 10;     // bytes of a request
inline constexpr std::size_t kLongestMessage = 4 << 10;  // bytes of a message of the page

// Returns 128 bits of the system's randomness, as 32 hexadecimal digits. Throws std::system_error.
std::string make_view_token();
// True for 32 digits and lower letters to f.
bool is_view_token(std::string_view text);

// The door of a server on 127.0.0.1.
struct ViewDoor {
  std::uint16_t port = 0;
  std::string token;
};

enum class ViewAnswer {
  kPage,
  kSocket,      // the WebSocket's handshake may go on
  kBadRequest,  // 400: no request, or one with a body
  kForbidden,   // 403: a wrong Host, Origin or token
  kNotFound,    // 404
  kNotAllowed   // 405: neither GET nor HEAD
};
struct ViewJudgement {
  ViewAnswer answer = ViewAnswer::kBadRequest;
  bool head_only = false;  // HEAD: the page's bytes are not wanted
};

// Judges the head of a request, up to its empty line. The page is at /, the socket at /touch. Host
// must be there once, and exactly 127.0.0.1:PORT or localhost:PORT; Origin likewise, and equal
// http://HOST, for the socket, and for the page where there is one; and the socket's only
// subprotocol must be gliss.TOKEN. Tokens are compared in a time that does not depend on what is in
// them.
ViewJudgement judge_request(std::string_view head, const ViewDoor& door);

// The place where a page's hand wants to be, m, in the world's frame.
struct HandMessage {
  Vec3 target = Vec3::Zero();
};
// How objects are to feel from now on.
struct TuneMessage {
  Method method = Method::kGregory;
  double stiffness = 0;  // N/m
  FrictionOptions friction = {};
  double settle = 0;  // s
  TextureOptions texture = {};
};
// The way in which surfaces are to be built from now on.
struct BuildMessage {
  Level level = {};
  std::optional<double> crease = {};  // degrees, 180: no edge is one; none: as the program has it
};
// Begins a recording, or ends it.
struct RecordMessage {
  bool on = false;
};
// Begins a replay of the last recording, or ends it.
struct ReplayMessage {
  bool on = false;
};
// Writes a scene that feels the same.
struct SaveMessage {};
// Lets a loop that was made safe go on.
struct EngageMessage {};
using ViewMessage = std::variant<HandMessage, TuneMessage, BuildMessage, RecordMessage,
                                 ReplayMessage, SaveMessage, EngageMessage>;

// Reads a text message: JSON with one key, {"hand": [x, y, z]}, {"tune": {"method", "stiffness",
// "friction": [at rest, slipping], "settle", "texture": {"kind", "height", "period"}}}, {"build":
// {"level", "construction", "crease"}}, {"record": true}, {"replay": true}, {"save": true},
// {"engage": true}. Returns nothing for any other text, for numbers that are not finite or out of
// range, and for one that is too long.
std::optional<ViewMessage> read_view_message(std::string_view text);

// Says how many messages a page may send: as many a second at last, and so many at once.
class MessageAllowance {
 public:
  static constexpr double kPerSecond = 200, kAtOnce = 200;
  // False for a message at `seconds` (of any clock) that is one too many.
  bool take(double seconds);

 private:
  double level_ = 0, last_ = 0;
};

}  // namespace gliss::tools
