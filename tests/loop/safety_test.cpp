// docs/safety.md names a test for each promise: each has one, and they are there.
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>

#include "tests/support/places.h"

namespace gliss {
namespace {

// "Suite/Name.test/0" without what parameters add.
std::vector<std::string> tests_here() {
  std::vector<std::string> names;
  const auto& all = *::testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const auto& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k)
      names.push_back(std::string(suite.name()) + "." + suite.GetTestInfo(k)->name());
  }
  return names;
}

// The tests that a line of the page names, as "Suite.test" or a pattern of such.
std::vector<std::string> tests_of(const std::string& line) {
  const std::regex pattern("`([*A-Z][A-Za-z0-9]*\\*?\\.?[a-z0-9A-Z_*]*)`");
  std::vector<std::string> names;
  for (std::sregex_iterator it(line.begin(), line.end(), pattern), end; it != end; ++it) {
    const std::string name = (*it)[1];
    if (name.find_first_of(".*") != name.npos) names.push_back(name);
  }
  return names;
}

TEST(Safety, names_tests_that_exist) {
  std::ifstream page(std::string(test::kTests) + "/../docs/safety.md");
  ASSERT_TRUE(page);
  const std::vector<std::string> names = tests_here();
  int promises = 0;
  for (std::string line; std::getline(page, line);) {
    const std::vector<std::string> named = tests_of(line);
    const bool is_promise = line.starts_with("| ") && line != "| promise | test |";
    promises += is_promise;
    EXPECT_TRUE(!is_promise || !named.empty()) << line;
    for (const std::string& wanted : named) {
      const bool found = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return fnmatch(wanted.c_str(), name.c_str(), 0) == 0 ||
               fnmatch(("*/" + wanted).c_str(), name.c_str(), 0) == 0 ||
               fnmatch(("*" + wanted + "/*").c_str(), name.c_str(), 0) == 0;
      });
      EXPECT_TRUE(found) << wanted;
    }
  }
  EXPECT_GT(promises, 20);
}

}  // namespace
}  // namespace gliss
