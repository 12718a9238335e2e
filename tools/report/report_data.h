// Data as the page of gliss report holds it: typed arrays in base64, thinned to what a screen
// shows.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/cli/command.h"

namespace gliss::tools {

std::string base64(std::span<const unsigned char> bytes);

Json packed(const std::vector<float>& values);          // {"f32": base64}, little-endian
Json packed(const std::vector<std::uint32_t>& values);  // {"u32": base64}

// Indices of about `most` of get(0) ... get(count - 1), in order: all that are finite where they
// are few enough, else the least and the largest of each stretch of equally many.
std::vector<std::size_t> extremes(std::size_t count, std::size_t most,
                                  const std::function<double(std::size_t)>& get);

// A column at those indices.
template <class Value, class Get>
Json packed_at(const std::vector<std::size_t>& indices, const Get& get) {
  std::vector<Value> values;
  values.reserve(indices.size());
  for (const std::size_t i : indices) values.push_back(static_cast<Value>(get(i)));
  return packed(values);
}

}  // namespace gliss::tools
