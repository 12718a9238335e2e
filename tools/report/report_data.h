// Data as the page of gliss report holds it: typed arrays in base64, thinned to what a screen
// shows, and as fine as it shows.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gliss/results/json.h"

namespace gliss::tools {

std::string base64(std::span<const unsigned char> bytes);

Json packed(const std::vector<float>& values);          // {"f32": base64}, little-endian
Json packed(const std::vector<std::uint32_t>& values);  // {"u32": base64}
// In two bytes each where they fit: {"u16": base64}.
Json narrowed(const std::vector<std::uint32_t>& values);

// So many interleaved columns in half the bytes, {"i16": base64, "offset": [...], "scale": [...]}:
// a value is offset + scale i, which is off by 1/65534 of its column's span, or of twice its
// largest size. A zero stays one. -32768 stands for what is not finite.
Json quantised(const std::vector<float>& values, std::size_t columns);

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
