// The middle one of some numbers. Private to host/ and tools/.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gliss {

// Returns the median, the upper one of an even number; 0 of none. None of them may be NaN.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace gliss
