// The numbers that are none, or no finite ones.
#pragma once

#include <limits>

namespace gliss::test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace gliss::test
