// Long work in pieces of about a tenth of a second, so that whoever waits is heard between them.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "gliss/base/stopwatch.h"

namespace gliss {

// The size of such pieces, in items: it doubles or halves with the time that they take. Threads may
// share it.
class Pace {
 public:
  explicit Pace(std::size_t first = 1, std::size_t most = SIZE_MAX)
      : size_(std::min(first, most)), most_(most) {}

  // Calls body(begin, end) over [0, count).
  template <class Body>
  void for_pieces(std::size_t count, Body body) {
    for (std::size_t begin = 0; begin < count;) {
      const std::size_t size = size_, end = begin + std::min(size, count - begin);
      const Stopwatch clock;
      body(begin, end);
      const double seconds = clock.seconds();
      if (seconds < 0.05 && end - begin == size) size_ = std::min(most_, 2 * size);
      if (seconds > 0.2) size_ = std::max<std::size_t>(1, size / 2);
      begin = end;
    }
  }

 private:
  std::atomic<std::size_t> size_;
  const std::size_t most_;
};

}  // namespace gliss
