// NumPy's .npy: a magic word, a version, the length of a header, the header, the data
// (numpy.lib.format). Private to host/tables.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gliss::npy {

inline constexpr std::string_view kMagic = "\x93NUMPY";
inline constexpr std::size_t kAlignment = 64;

// Version 1.0: the header's length in two bytes; it is filled up so that data begin aligned.
inline std::string header_of(std::string dictionary) {
  constexpr std::size_t kBefore = 10;
  dictionary.resize(
      (kBefore + dictionary.size() + 1 + kAlignment - 1) / kAlignment * kAlignment - kBefore - 1,
      ' ');
  dictionary += '\n';
  std::string header(kMagic);
  header += {'\x01', '\x00', static_cast<char>(dictionary.size() & 255),
             static_cast<char>(dictionary.size() >> 8)};
  return header + dictionary;
}

}  // namespace gliss::npy
