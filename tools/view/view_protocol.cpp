#include "tools/view/view_protocol.h"

#include <sys/random.h>

#include <algorithm>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

#include "gliss/query/query.h"

namespace gliss::tools {
namespace {

namespace http = boost::beast::http;
using Json = nlohmann::json;
using Fields = http::request<http::empty_body>;

constexpr double kMostMetres = 1e6, kMostStiffness = 1e9;

// The only value of a field; nothing where it is not there, or more than once.
std::optional<std::string_view> only(const Fields& request, http::field name) {
  const auto [first, last] = request.equal_range(name);
  if (first == last || std::next(first) != last) return std::nullopt;
  const auto value = first->value();
  return std::string_view(value.data(), value.size());
}

// Compares in a time that depends on the lengths alone.
bool is_same(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned char differs = 0;
  for (std::size_t i = 0; i < one.size(); ++i)
    differs |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]);
  return differs == 0;
}

bool may_upgrade(const Fields& request, const std::string& origin, const ViewDoor& door) {
  return only(request, http::field::origin) == origin &&
         is_same(only(request, http::field::sec_websocket_protocol).value_or(""),
                 "gliss." + door.token);
}

ViewAnswer answer_to(const Fields& request, const ViewDoor& door) {
  if (request.version() != 11 || request.has_content_length() || request.chunked())
    return ViewAnswer::kBadRequest;
  const auto host = only(request, http::field::host);
  const std::string port = ":" + std::to_string(door.port);
  if (host != "127.0.0.1" + port && host != "localhost" + port) return ViewAnswer::kForbidden;
  const std::string origin = "http://" + std::string(*host);
  if (request.count(http::field::origin) > 0 && only(request, http::field::origin) != origin)
    return ViewAnswer::kForbidden;
  const bool is_head = request.method() == http::verb::head;
  if (request.method() != http::verb::get && !is_head) return ViewAnswer::kNotAllowed;
  if (request.target() == "/") return ViewAnswer::kPage;
  if (request.target() != "/touch") return ViewAnswer::kNotFound;
  if (is_head || !boost::beast::websocket::is_upgrade(request)) return ViewAnswer::kBadRequest;
  return may_upgrade(request, origin, door) ? ViewAnswer::kSocket : ViewAnswer::kForbidden;
}

// Returns null where there is no such key.
const Json& member(const Json& object, const char* key) {
  static const Json none;
  const auto found = object.find(key);
  return found == object.end() ? none : *found;
}

// Reads a list of as many numbers, each of a size up to `most`.
template <std::size_t count>
std::optional<std::array<double, count>> numbers_of(const Json& list, double most) {
  if (!list.is_array() || list.size() != count) return std::nullopt;
  std::array<double, count> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    if (!list[i].is_number()) return std::nullopt;
    numbers[i] = list[i].get<double>();
    if (!(std::abs(numbers[i]) <= most)) return std::nullopt;
  }
  return numbers;
}

std::optional<ViewMessage> hand_of(const Json& value) {
  const auto target = numbers_of<3>(value, kMostMetres);
  if (!target) return std::nullopt;
  return HandMessage{Vec3((*target)[0], (*target)[1], (*target)[2])};
}

std::optional<TextureOptions> texture_of(const Json& value) {
  if (!value.is_object() || value.size() != 3) return std::nullopt;
  const Json &kind = member(value, "kind"), &height = member(value, "height"),
             &period = member(value, "period");
  if (!kind.is_string() || !height.is_number() || !period.is_number()) return std::nullopt;
  if (kind == "none") return TextureOptions{};
  const auto relief = find_named(kReliefNames, kind.get_ref<const std::string&>());
  if (!relief) return std::nullopt;
  const TextureOptions texture{*relief, height.get<double>(), period.get<double>()};
  if (fault_of(texture) != nullptr) return std::nullopt;
  return texture;
}

std::optional<ViewMessage> tune_of(const Json& value) {
  if (!value.is_object() || value.size() != 5) return std::nullopt;
  const Json &name = member(value, "method"), &stiffness = member(value, "stiffness"),
             &settle = member(value, "settle");
  const auto friction = numbers_of<2>(member(value, "friction"), FrictionOptions::kMost);
  const auto texture = texture_of(member(value, "texture"));
  if (!name.is_string() || !stiffness.is_number() || !settle.is_number() || !friction || !texture)
    return std::nullopt;
  const auto method = find_named(kMethodNames, name.get_ref<const std::string&>());
  if (!method) return std::nullopt;
  TuneMessage tune{*method, stiffness.get<double>(), {}, settle.get<double>(), *texture};
  tune.friction.at_rest = (*friction)[0];
  tune.friction.slipping = (*friction)[1];
  const bool is_good = tune.stiffness > 0 && tune.stiffness <= kMostStiffness && tune.settle >= 0 &&
                       tune.settle <= kMostSettleTime && fault_of(tune.friction) == nullptr;
  if (!is_good) return std::nullopt;
  return tune;
}

std::optional<ViewMessage> build_of(const Json& value) {
  if (!value.is_object() || value.size() != 3 || !value.contains("crease")) return std::nullopt;
  const Json &level = member(value, "level"), &construction = member(value, "construction"),
             &crease = member(value, "crease");
  if (!level.is_string() || !construction.is_string()) return std::nullopt;
  const auto chosen = find_level(level.get_ref<const std::string&>());
  const auto made = find_named(kConstructionNames, construction.get_ref<const std::string&>());
  if (!chosen || !made) return std::nullopt;
  BuildMessage build{*chosen};
  build.level.construction = *made;
  if (crease.is_null()) return build;
  if (!crease.is_number()) return std::nullopt;
  build.crease = crease.get<double>();
  if (!(*build.crease >= 0 && *build.crease <= 180)) return std::nullopt;
  return build;
}

}  // namespace

std::string make_view_token() {
  std::array<unsigned char, 16> bytes;
  ssize_t got;
  do {
    got = getrandom(bytes.data(), bytes.size(), 0);
  } while (got < 0 && errno == EINTR);
  if (got != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "the system's randomness");
  std::string token;
  for (const unsigned char byte : bytes) {
    for (const int digit : {byte >> 4, byte & 15}) token += "0123456789abcdef"[digit];
  }
  return token;
}

bool is_view_token(std::string_view text) {
  return text.size() == 32 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

ViewJudgement judge_request(std::string_view head, const ViewDoor& door) {
  if (head.size() > kLongestHead || !head.ends_with("\r\n\r\n")) return {};
  http::request_parser<http::empty_body> parser;
  parser.header_limit(static_cast<std::uint32_t>(kLongestHead));
  boost::system::error_code error;
  const std::size_t used = parser.put(boost::asio::buffer(head.data(), head.size()), error);
  if (error || used != head.size() || !parser.is_header_done()) return {};
  const Fields& request = parser.get();
  return {answer_to(request, door), request.method() == http::verb::head};
}

std::optional<ViewMessage> read_view_message(std::string_view text) {
  if (text.size() > kLongestMessage) return std::nullopt;
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object() || message.size() != 1) return std::nullopt;
  const std::string& what = message.begin().key();
  const Json& value = message.begin().value();
  if (what == "hand") return hand_of(value);
  if (what == "tune") return tune_of(value);
  if (what == "build") return build_of(value);
  if (what == "replay" && value.is_boolean()) return ReplayMessage{value.get<bool>()};
  if (what == "save" && value == true) return SaveMessage{};
  if (what == "record" && value.is_boolean()) return RecordMessage{value.get<bool>()};
  if (what == "engage" && value == true) return EngageMessage{};
  return std::nullopt;
}

bool MessageAllowance::take(double seconds) {
  level_ = std::max(0.0, level_ - kPerSecond * std::max(0.0, seconds - last_));
  last_ = seconds;
  return ++level_ <= kAtOnce;
}

}  // namespace gliss::tools
