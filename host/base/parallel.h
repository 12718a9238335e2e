// Loops that may run on many threads, without saying which library does it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

namespace gliss {

// Runs body(begin, end) over [0, count) in pieces of `grain`, on one thread or on many.
using ParallelFor = std::function<void(std::size_t count, std::size_t grain,
                                       const std::function<void(std::size_t, std::size_t)>& body)>;

inline void serial_for(std::size_t count, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)>& body) {
  for (std::size_t begin = 0; begin < count; begin += grain)
    body(begin, std::min(count, begin + grain));
}

}  // namespace gliss
