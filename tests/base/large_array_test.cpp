#include "gliss/base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

namespace gliss {
namespace {

TEST(LargeArray, lies_in_huge_pages_once_it_is_large) {
  constexpr std::size_t kMany = HugePages<double>::kLarge / sizeof(double);
  LargeArray<double> numbers(kMany - 1);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  numbers.push_back(static_cast<double>(kMany - 1));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % HugePages<double>::kPage, 0u);
  for (std::size_t i = 0; i < kMany; ++i) ASSERT_EQ(numbers[i], static_cast<double>(i));
  numbers.resize(3);
  numbers.shrink_to_fit();
  EXPECT_EQ(numbers, (LargeArray<double>{0, 1, 2}));
}

}  // namespace
}  // namespace gliss
