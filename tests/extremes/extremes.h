// Bounds at the extremes: each test holds its worst values to them and, where GLISS_EXTREMES names
// a file, adds rows to it. tools/extremes.sh makes EXTREMES.md of those.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

namespace gliss::test {

// Samples to take: as many as CI has time for; with GLISS_LONG_TESTS=1 all; with another number so
// many times CI's.
inline std::uint64_t samples(std::uint64_t few, std::uint64_t many) {
  const char* text = std::getenv("GLISS_LONG_TESTS");
  if (text == nullptr) return few;
  const std::uint64_t times = std::strtoull(text, nullptr, 10);
  return times > 1 ? std::min(many, times * few) : many;
}

struct Bound {
  const char* group;            // a heading of EXTREMES.md
  std::string what;             // is bounded, over which inputs, in which unit
  double goal;                  // at most
  double limit = goal;          // what is reached, where that is more
  const char* limited_by = "";  // why
};

// `worst` of `count` samples. NaN holds no bound.
inline void hold(const Bound& bound, double worst, std::uint64_t count) {
  EXPECT_LE(worst, bound.limit) << bound.group << ": " << bound.what;
  EXPECT_TRUE(bound.limit <= bound.goal || *bound.limited_by != '\0')
      << "a missed goal has a reason";
  const std::string row =
      fmt::format("{}\t{}\t{}\t{:.2g}\t{:.2g}\t{}\n", bound.group, bound.what, count, bound.goal,
                  worst, worst <= bound.goal ? "" : bound.limited_by);
  fmt::print("  {}", row);
  if (const char* path = std::getenv("GLISS_EXTREMES")) std::ofstream(path, std::ios::app) << row;
}

// The name of a value that has one, for INSTANTIATE_TEST_SUITE_P, which takes no others.
inline constexpr auto kNameOf = [](const auto& info) {
  std::string name = info.param.name;
  std::erase(name, ',');
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
};

}  // namespace gliss::test
