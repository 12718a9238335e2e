#include "tools/report/report_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gliss::tools {
namespace {

constexpr std::int16_t kMostSteps = 32767, kNotFinite = -32768;

// How a column's values become steps from -kMostSteps to kMostSteps.
struct Steps {
  double offset = 0, scale = 1;

  Steps(double least, double largest) {
    if (least > largest) return;  // no values
    if (least > 0 || largest < 0) offset = (least + largest) / 2;
    const double reach = std::max(largest - offset, offset - least);
    if (reach > 0) scale = reach / kMostSteps;
  }
  std::int16_t operator()(double value) const {
    return static_cast<std::int16_t>(std::lround((value - offset) / scale));
  }
};

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

Json narrowed(const std::vector<std::uint32_t>& values) {
  const bool fit = std::all_of(values.begin(), values.end(), [](std::uint32_t value) {
    return value <= std::numeric_limits<std::uint16_t>::max();
  });
  if (!fit) return packed(values);
  return {{"u16", base64_of(std::vector<std::uint16_t>(values.begin(), values.end()))}};
}

Json quantised(const std::vector<float>& values, std::size_t columns) {
  Json offset = Json::array(), scale = Json::array();
  std::vector<std::int16_t> steps(values.size(), kNotFinite);
  for (std::size_t column = 0; column < columns; ++column) {
    const auto each = [&](const auto& take) {
      for (std::size_t i = column; i < values.size(); i += columns) {
        const auto value = static_cast<double>(values[i]);
        if (std::isfinite(value)) take(i, value);
      }
    };
    double least = std::numeric_limits<double>::infinity(), largest = -least;
    each([&](std::size_t, double value) {
      least = std::min(least, value);
      largest = std::max(largest, value);
    });
    const Steps step_of(least, largest);
    each([&](std::size_t i, double value) { steps[i] = step_of(value); });
    offset.push_back(step_of.offset);
    scale.push_back(step_of.scale);
  }
  return {{"i16", base64_of(steps)}, {"offset", offset}, {"scale", scale}};
}

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
