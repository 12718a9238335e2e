#include "tools/report/report_data.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace gliss::tools {
namespace {

template <class Value>
std::string base64_of(const std::vector<Value>& values) {
  static_assert(std::endian::native == std::endian::little, "pages hold little-endian numbers");
  return base64(
      {reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(Value)});
}

}  // namespace

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < have ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= have ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

Json packed(const std::vector<float>& values) { return {{"f32", base64_of(values)}}; }
Json packed(const std::vector<std::uint32_t>& values) { return {{"u32", base64_of(values)}}; }

std::vector<std::size_t> extremes(std::size_t count, std::size_t most,
                                  const std::function<double(std::size_t)>& get) {
  const std::size_t stretches = count <= most ? count : std::max<std::size_t>(1, most / 2);
  std::vector<std::size_t> kept;
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * count / stretches, end = (s + 1) * count / stretches;
    std::size_t least = count, largest = count;
    for (std::size_t i = begin; i < end; ++i) {
      const double value = get(i);
      if (!std::isfinite(value)) continue;
      if (least == count || value < get(least)) least = i;
      if (largest == count || value > get(largest)) largest = i;
    }
    if (least == count) continue;
    kept.push_back(std::min(least, largest));
    if (least != largest) kept.push_back(std::max(least, largest));
  }
  return kept;
}

}  // namespace gliss::tools
