#include "gliss/base/large_array.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>

namespace gliss {
namespace {

// False where nobody gets huge pages.
bool has_huge_pages() {
  std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
  std::string text;
  return std::getline(file, text) && text.find("[never]") == text.npos;
}

// KiB of huge pages in the mapping of this process where `memory` lies.
long huge_pages_at(const void* memory) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(memory);
  std::ifstream mappings("/proc/self/smaps");
  bool is_here = false;
  for (std::string line; std::getline(mappings, line);) {
    std::istringstream words(line);
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    if (words >> std::hex >> begin >> dash >> end && dash == '-')
      is_here = begin <= wanted && wanted < end;
    constexpr std::string_view kHuge = "AnonHugePages:";
    if (is_here && line.starts_with(kHuge)) return std::stol(line.substr(kHuge.size()));
  }
  return 0;
}

TEST(LargeArray, lies_in_huge_pages_once_it_is_large) {
  constexpr std::size_t kMany = HugePages<double>::kLarge / sizeof(double);
  LargeArray<double> numbers(kMany - 1);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  numbers.push_back(static_cast<double>(kMany - 1));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % HugePages<double>::kPage, 0u);
  if (has_huge_pages()) {
    EXPECT_GT(huge_pages_at(numbers.data()), 0);
  }
  for (std::size_t i = 0; i < kMany; ++i) ASSERT_EQ(numbers[i], static_cast<double>(i));
  numbers.resize(3);
  numbers.shrink_to_fit();
  EXPECT_EQ(numbers, (LargeArray<double>{0, 1, 2}));
}

}  // namespace
}  // namespace gliss
