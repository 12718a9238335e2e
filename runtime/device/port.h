// Ports of this machine, as people write them.
#pragma once

#include <charconv>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace gliss::detail {

// The port that a whole text is; `name` is whose it is. Throws std::invalid_argument.
inline std::uint16_t parse_port(const std::string& name, const std::string& text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, port);
  if (text.empty() || error != std::errc() || stop != end)
    throw std::invalid_argument(name + ": '" + text + "' is not a number that fits");
  return port;
}

}  // namespace gliss::detail
