// docs/safety.md names a test for each promise: they are there.
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

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

TEST(Safety, names_tests_that_exist) {
  std::ifstream page(std::string(test::kTests) + "/../docs/safety.md");
  ASSERT_TRUE(page);
  std::stringstream text;
  text << page.rdbuf();
  const std::string words = text.str();
  const std::vector<std::string> names = tests_here();
  const std::regex pattern("`([*A-Z][A-Za-z]*\\*?\\.?[a-z0-9A-Z_*]*)`");
  int checked = 0;
  for (std::sregex_iterator it(words.begin(), words.end(), pattern), end; it != end; ++it) {
    const std::string wanted = (*it)[1];
    if (wanted.find('.') == wanted.npos && wanted.find('*') == wanted.npos) continue;
    ++checked;
    const bool found = std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      return fnmatch(wanted.c_str(), name.c_str(), 0) == 0 ||
             fnmatch(("*/" + wanted).c_str(), name.c_str(), 0) == 0 ||
             fnmatch(("*" + wanted + "/*").c_str(), name.c_str(), 0) == 0;
    });
    EXPECT_TRUE(found) << wanted;
  }
  EXPECT_GT(checked, 20);
}

}  // namespace
}  // namespace gliss
