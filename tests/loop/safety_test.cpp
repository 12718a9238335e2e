// docs/safety.md names a test for each promise: each has one, which is there and runs. Its figures
// are those of the code.
#include <fnmatch.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "gliss/contact/tracker.h"
#include "gliss/device/udp_server.h"
#include "gliss/haply/haply_device.h"
#include "gliss/loop/loop.h"
#include "gliss/query/contact_tracker.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tools/cli/terminal/interrupt.h"

namespace gliss {
namespace {

std::string page() {
  std::ifstream file(std::string(test::kTests) + "/../docs/safety.md");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// "Suite/Name.test/0" without what parameters add.
std::string name_of(const ::testing::TestInfo& test) {
  return std::string(test.test_suite_name()) + "." + test.name();
}

std::vector<std::string> tests_here() {
  std::vector<std::string> names;
  const auto& all = *::testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const auto& suite = *all.GetTestSuite(i);
    for (int k = 0; k < suite.total_test_count(); ++k)
      names.push_back(name_of(*suite.GetTestInfo(k)));
  }
  return names;
}

// The tests that a text names, as "Suite.test" or a pattern of such.
std::vector<std::string> tests_of(const std::string& text) {
  const std::regex pattern("`([*A-Z][A-Za-z0-9]*\\*?\\.?[a-z0-9A-Z_*]*)`");
  std::vector<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) {
    const std::string name = (*it)[1];
    if (name.find_first_of(".*") != name.npos) names.push_back(name);
  }
  return names;
}

bool is_meant(const std::string& name, const std::string& wanted) {
  return fnmatch(wanted.c_str(), name.c_str(), 0) == 0 ||
         fnmatch(("*/" + wanted).c_str(), name.c_str(), 0) == 0 ||
         fnmatch(("*" + wanted + "/*").c_str(), name.c_str(), 0) == 0;
}

TEST(Safety, names_tests_that_exist_and_run) {
  std::istringstream lines(page());
  const std::vector<std::string> names = tests_here();
  int promises = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> named = tests_of(line);
    const bool is_promise = line.starts_with("| ") && line != "| promise | test |";
    promises += is_promise;
    EXPECT_TRUE(!is_promise || !named.empty()) << line;
    for (const std::string& wanted : named) {
      bool is_there = false;
      for (const std::string& name : names) {
        if (!is_meant(name, wanted)) continue;
        is_there = true;
        EXPECT_EQ(name.find("DISABLED_"), name.npos) << name;
      }
      EXPECT_TRUE(is_there) << wanted;
    }
  }
  EXPECT_GT(promises, 20);
}

// A skip of a test that the page names is a failure where nothing that it needs is missing: what
// tools/test.sh installs, and the rights of root.
class NoSkips : public ::testing::EmptyTestEventListener {
  void OnTestEnd(const ::testing::TestInfo& test) override {
    if (!test.result()->Skipped() || !test::all_is_required() || geteuid() != 0) return;
    for (const std::string& wanted : tests_of(page()))
      if (is_meant(name_of(test), wanted)) ADD_FAILURE() << "docs/safety.md needs it: " << wanted;
  }
};
[[maybe_unused]] const bool kListens =
    (::testing::UnitTest::GetInstance()->listeners().Append(new NoSkips), true);

double in_ms(Nanoseconds time) { return std::chrono::duration<double, std::milli>(time).count(); }

GuardLimits limits_at(int hz) {
  return guard_limits({.period = Nanoseconds(std::chrono::seconds(1)) / hz});
}
// The slowest whole rate of which this holds, Hz, among those of which it holds from there on.
template <class Holds>
double slowest_rate(Holds holds) {
  int rate = 1000;
  while (holds(rate - 1)) --rate;
  return rate;
}

TEST(Safety, promises_the_figures_of_the_code) {
  const GuardLimits guard;
  const double ramp = in_ms(guard.ramp_to), watchdog = in_ms(UdpServerOptions{}.watchdog),
               slowest = slowest_rate([](int hz) {
                 try {
                   return limits_at(hz).ramp_to > Nanoseconds(0);
                 } catch (const std::invalid_argument&) {
                   return false;
                 }
               }),
               follows = slowest_rate(
                   [&](int hz) { return limits_at(hz).hold_after == guard.hold_after; }),
               periods = in_ms(limits_at(500).hold_after) / 2;
  struct Promise {
    const char* words;  // # where there is a figure
    std::vector<double> figures;
  };
  const std::string text = page();
  for (const auto& [words, figures] : std::vector<Promise>{
           {"at # to # Hz an input is late after # periods", {slowest, follows, periods}},
           {"holds the force, fades it from # to # ms and", {in_ms(guard.ramp_from), ramp}},
           {"The force is gone within # ms of the device's last word", {watchdog}},
           {"at most # N until the hand has been outside", {guard.engage_below}},
           {"the largest force rises over # s[.]", {in_seconds(guard.engage_ramp)}},
           {"leaves no force on Haply's device after # ms", {watchdog}},
           {"leaves no force on a served device after # ms;", {watchdog}},
           {"is a fault or a late input within # ms[.]", {ramp}},
           {"let the force fade to zero within # ms; zero is", {ramp}},
           {"A second signal leaves # s for that", {double{tools::kLastSeconds}}},
           {"Friction that is negative, not finite, above #, or", {FrictionOptions::kMost}},
           {"A tick spends at most # evaluations of patches", {ContactTracker::kTickEvaluations}},
           {"with many HIPs spends at most # evaluations:",
            {Tracker::kStepEvaluations + ContactTracker::kTickEvaluations}},
           {"A tool has at most # contacts, HIPs times", {Tracker::kMostContacts}},
           {"brings a random pass of # bytes", {double{udp::Pass{}.size()}}},
           {"keeps its place for # s, without", {double{udp::kPlaceKept.count()}}},
           {"fades by `max_rate` within # ms[.]", {watchdog}}}) {
    const std::string pattern = std::regex_replace(words, std::regex("#"), "([0-9][0-9.,]*)");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(text, found, std::regex(pattern))) << words;
    ASSERT_EQ(found.size(), figures.size() + 1) << words;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      std::string figure = found[i + 1];
      std::erase(figure, ',');
      EXPECT_DOUBLE_EQ(std::stod(figure), figures[i]) << words;
    }
  }
  EXPECT_LT(in_ms(HaplyDevice::kForceLife), watchdog);
}

}  // namespace
}  // namespace gliss
