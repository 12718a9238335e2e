#include "tools/cli/terminal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace gliss {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

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

}  // namespace

std::string for_terminal(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = length_of_character(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length > 0 && !is_control(character)) {
      shown += character;
    } else {
      for (const char c : character)
        shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    text.remove_prefix(character.size());
  }
  return shown;
}

void tell(std::string_view text) { std::fputs(for_terminal(text).c_str(), stderr); }

}  // namespace gliss
