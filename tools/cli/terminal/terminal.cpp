#include "tools/cli/terminal/terminal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "gliss/base/utf8.h"

namespace gliss::tools {
namespace {

// The bytes of the character that the text begins with; 0: it is no UTF-8. Not strict about
// overlong forms: terminals are about them.
std::size_t length_of_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t length = lead < 0x80                   ? 1
                             : lead >= 0xc2 && lead < 0xe0 ? 2
                             : lead >= 0xe0 && lead < 0xf0 ? 3
                             : lead >= 0xf0 && lead < 0xf5 ? 4
                                                           : 0;
  const std::string_view rest = text.substr(0, length).substr(std::min<std::size_t>(length, 1));
  return rest.size() + 1 >= length && std::all_of(rest.begin(), rest.end(), is_continuation)
             ? length
             : 0;
}

// True for a control character: one byte, or U+0080 to U+009F, which some terminals obey as well.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  if (character.size() == 2)
    return first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
  return character.size() == 1 && (first < ' ' || first == 0x7f) && first != '\n';
}

// The text with escape(character) in place of control characters and of bytes that are no UTF-8.
template <class Escape>
std::string escaped(std::string_view text, Escape escape) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = length_of_character(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    const bool is_plain = length > 0 && !is_control(character);
    shown += is_plain ? std::string(character) : escape(character);
    text.remove_prefix(character.size());
  }
  return shown;
}

}  // namespace

std::string for_terminal(std::string_view text) {
  return escaped(text, [](std::string_view character) {
    std::string bytes;
    for (const char c : character) bytes += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    return bytes;
  });
}

std::string json_for_terminal(std::string_view json) {
  // The last byte of U+007F and of U+0080 to U+009F is their number.
  return escaped(json, [](std::string_view character) {
    return fmt::format("\\u{:04x}", static_cast<unsigned char>(character.back()));
  });
}

void tell(std::string_view text) { std::fputs(for_terminal(text).c_str(), stderr); }

}  // namespace gliss::tools
