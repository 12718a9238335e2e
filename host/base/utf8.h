// UTF-8, as far as cutting a text needs it.
#pragma once

#include <cstddef>
#include <string_view>

namespace gliss {

// True for a byte that a character goes on with.
inline bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

// Cuts a text to the whole characters that fit into `most` bytes.
inline std::string_view cut_text(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text;
  while (most > 0 && is_continuation(text[most])) --most;
  return text.substr(0, most);
}

}  // namespace gliss
