// Messages of code that links no formatting library.
#pragma once

#include <concepts>
#include <string>
#include <type_traits>

namespace gliss::detail {

// The pieces one after the other: text as it is, whole numbers in digits.
template <class... Pieces>
std::string message(const Pieces&... pieces) {
  std::string text;
  const auto append = [&](const auto& piece) {
    if constexpr (std::integral<std::decay_t<decltype(piece)>>) {
      text += std::to_string(piece);
    } else {
      text += piece;
    }
  };
  (append(pieces), ...);
  return text;
}

}  // namespace gliss::detail
