// Conditions on arguments.
#pragma once

#include <stdexcept>

namespace gliss {

// Throws std::invalid_argument(what) unless the condition holds.
inline void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

}  // namespace gliss
