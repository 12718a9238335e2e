// Tools that the fuzz targets share. A target is a function over raw bytes: libFuzzer
// (tools/fuzz.sh) looks for bytes that break it, replay.cpp runs it over the files of a corpus.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "tests/support/scratch_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace gliss::fuzz {

// Ends the program where a promise is broken, so that the input is kept.
inline void require(bool kept, const std::string& promise) {
  if (kept) return;
  std::fprintf(stderr, "broken: %s\n", promise.c_str());
  std::abort();
}

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Choices from the front of the input and numbers from its back, so that one more choice leaves the
// numbers as they were. Zeros where the input is used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  bool empty() const { return left_.empty(); }
  std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  // 0 to count - 1
  unsigned choice(unsigned count) { return byte() % count; }
  bool flag() { return choice(2) == 1; }
  std::string_view rest() const { return text_of(left_.data(), left_.size()); }

  template <class Number>
  Number number() {
    const std::size_t bytes = std::min(sizeof(Number), left_.size());
    Number value{};
    if (bytes > 0) std::memcpy(&value, left_.last(bytes).data(), bytes);
    left_ = left_.first(left_.size() - bytes);
    return value;
  }

 private:
  std::span<const std::uint8_t> left_;
};

// For readers that take a path: the same file, over and over.
inline const test::ScratchFolder& folder() {
  static const test::ScratchFolder folder;
  return folder;
}

}  // namespace gliss::fuzz
