// Messages of code that links no formatting library.
#pragma once

#include <charconv>
#include <concepts>
#include <iterator>
#include <string>
#include <type_traits>

namespace gliss::detail {

// The pieces one after the other: text as it is, whole numbers in digits, others with six of them.
template <class... Pieces>
std::string message(const Pieces&... pieces) {
  std::string text;
  const auto append = [&](const auto& piece) {
    if constexpr (std::integral<std::decay_t<decltype(piece)>>) {
      text += std::to_string(piece);
    } else if constexpr (std::floating_point<std::decay_t<decltype(piece)>>) {
      char digits[32];
      text.append(
          digits,
          std::to_chars(digits, std::end(digits), piece, std::chars_format::general, 6).ptr);
    } else {
      text += piece;
    }
  };
  (append(pieces), ...);
  return text;
}

}  // namespace gliss::detail
