// Quantities of the command line, and the words of the progress display.
#include "gliss/base/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"
#include "tools/cli/terminal/progress_text.h"

namespace gliss {
namespace {

using ::testing::HasSubstr;
using tools::count_text, tools::duration_text, tools::finished_text, tools::LinePace,
    tools::progress_bar, tools::progress_text;

TEST(Units, LengthsAreTheNearestDouble) {
  EXPECT_EQ(parse_length("2mm"), 0.002);
  EXPECT_EQ(parse_length("9mm"), 0.009);  // 9 * 1e-3 is not
  EXPECT_EQ(parse_length(" 4 cm "), 0.04);
  EXPECT_EQ(parse_length("1e-3m"), 0.001);
  EXPECT_EQ(parse_length("5um"), 5e-6);
  EXPECT_EQ(parse_length("5\u00B5m"), 5e-6);
  EXPECT_EQ(parse_length("5\u03BCm"), 5e-6);
  EXPECT_EQ(parse_length("250nm"), 250e-9);
  EXPECT_EQ(parse_length("1in"), 0.0254);
  EXPECT_EQ(parse_length("-0.25"), -0.25);
  EXPECT_EQ(parse_length("+.5m"), 0.5);
}

TEST(Units, Stiffnesses) {
  EXPECT_EQ(parse_stiffness("0.5N/mm"), 500);
  EXPECT_EQ(parse_stiffness("300 N/m"), 300);
  EXPECT_EQ(parse_stiffness("1.5kN/m"), 1500);
  EXPECT_EQ(parse_stiffness("20mN/mm"), 20);
  EXPECT_EQ(parse_stiffness("1N/um"), 1e6);
  EXPECT_EQ(parse_stiffness("750"), 750);
}

TEST(Units, ForcesAndDampings) {
  EXPECT_EQ(parse_force("0.5N"), 0.5);
  EXPECT_EQ(parse_force("20 mN"), 0.02);
  EXPECT_EQ(parse_force("3"), 3);
  EXPECT_EQ(parse_viscosity("3 N s/m"), 3);
  EXPECT_EQ(parse_viscosity("3Ns/m"), 3);
  EXPECT_EQ(parse_viscosity("2 mN s/mm"), 2);
  EXPECT_EQ(parse_viscosity("0.1"), 0.1);
  EXPECT_EQ(parse_damping("2s/m"), 2);
  EXPECT_EQ(parse_damping("2 ms/mm"), 2);
  EXPECT_EQ(parse_damping("1.5"), 1.5);
}

TEST(Units, UnitsOfMeshes) {
  EXPECT_EQ(parse_unit("mm"), 1e-3);
  EXPECT_EQ(parse_unit("m"), 1);
  EXPECT_EQ(parse_unit("in"), 0.0254);
  EXPECT_EQ(parse_unit("0.001"), 1e-3);
  EXPECT_EQ(parse_unit("10mm"), 0.01);
}

TEST(Units, ErrorsQuoteTheTextAndSayWhatIsAccepted) {
  const auto error = [](double (*parse)(std::string_view), const char* text) {
    return test::message_of<UnitError>([&] { parse(text); });
  };
  EXPECT_EQ(
      error(parse_length, "2mn"),
      "'2mn' has an unknown unit 'mn'; a length is a number in m, cm, mm, um, nm or in, or in "
      "metres without a unit");
  EXPECT_THAT(error(parse_length, "mm"), HasSubstr("'mm' does not begin with a finite number"));
  EXPECT_THAT(error(parse_length, ""), HasSubstr("'' does not begin"));
  EXPECT_THAT(error(parse_length, "2 m m"), HasSubstr("unknown unit 'm m'"));
  EXPECT_THAT(error(parse_length, "2Mm"), HasSubstr("unknown unit 'Mm'"));
  EXPECT_THAT(error(parse_length, "1,5mm"), HasSubstr("unknown unit ',5mm'"));
  EXPECT_THAT(error(parse_length, "0x10"), HasSubstr("unknown unit 'x10'"));
  EXPECT_THAT(error(parse_length, "+-2"), HasSubstr("does not begin"));
  for (const char* text : {"nan", "inf mm", "-infinity", "1e999mm"}) {
    EXPECT_THAT(error(parse_length, text), HasSubstr("finite number")) << text;
  }
  EXPECT_THAT(error(parse_stiffness, "1e308 N/um"), HasSubstr("too large"));
  EXPECT_THAT(error(parse_stiffness, "5 N"), HasSubstr("0.5N/mm"));
  EXPECT_THAT(error(parse_stiffness, "5 N/"), HasSubstr("unknown unit 'N/'"));
  EXPECT_THAT(error(parse_stiffness, "5 mm"), HasSubstr("unknown unit 'mm'"));
  EXPECT_THAT(error(parse_force, "5 N/m"), HasSubstr("a force is a number in N"));
  EXPECT_THAT(error(parse_viscosity, "5 N/m"), HasSubstr("such as 3 N s/m"));
  EXPECT_THAT(error(parse_viscosity, "5 s/m"), HasSubstr("unknown unit 's/m'"));
  EXPECT_THAT(error(parse_damping, "5 N s/m"), HasSubstr("such as 2 s/m"));
  EXPECT_THAT(error(parse_unit, "0"), HasSubstr("'0' is not positive"));
  EXPECT_THAT(error(parse_unit, "feet"), HasSubstr("a unit is m, cm"));
}

TEST(ProgressText, CountsAndDurationsAreShort) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(999.6), "1.00 k");
  EXPECT_EQ(count_text(12345), "12.3 k");
  EXPECT_EQ(count_text(4.56e6), "4.56 M");
  EXPECT_EQ(count_text(2.5e17), "250000 T");
  EXPECT_EQ(duration_text(0.84), "0.8 s");
  EXPECT_EQ(duration_text(42.4), "42 s");
  EXPECT_EQ(duration_text(187), "3:07 min");
  EXPECT_EQ(duration_text(8100), "2:15 h");
}

TEST(ProgressText, SaysRateAndTimeLeft) {
  EXPECT_EQ(progress_text({0, 1000, 0}, "points"), "  0 %  0 of 1.00 k points");
  EXPECT_EQ(progress_text({250, 1000, 5}, "points"),
            " 25 %  250 of 1.00 k points  50/s  15 s left");
  EXPECT_EQ(progress_text({1000, 1000, 5}, "points"), "100 %  1.00 k of 1.00 k points  200/s");
  EXPECT_EQ(progress_text({0, 1000, 5}, "points"), "  0 %  0 of 1.00 k points  5.0 s so far");
  EXPECT_EQ(progress_text({0, 0, 5}, ""), "5.0 s");
  EXPECT_EQ(progress_text({250, 0, 5}, "points"), "250 points  50/s");
  EXPECT_EQ(finished_text({1000, 1000, 5}, "points"), "1.00 k points in 5.0 s, 200/s");
  // So few a second tell nothing.
  EXPECT_EQ(progress_text({2, 4, 2}, "rows"), " 50 %  2 of 4 rows  2.0 s left");
  EXPECT_EQ(finished_text({3, 3, 2.4}, "rows"), "3 rows in 2.4 s");
  EXPECT_EQ(progress_bar({5, 10, 1}, 12), "[#####-----]");
  EXPECT_EQ(progress_bar({20, 10, 1}, 6), "[####]");
  EXPECT_EQ(progress_bar({5, 0, 1}, 12), "");
}

TEST(ProgressText, LogLinesAreFew) {
  LinePace pace;
  int lines = 0;
  for (std::uint64_t done = 0; done <= 1000; ++done)
    lines += pace.due({done, 1000, 0.1 * static_cast<double>(done)});
  EXPECT_GE(lines, 9);  // 100 s: each 10 %
  EXPECT_LE(lines, 10);
  LinePace quick;
  EXPECT_FALSE(quick.due({900, 1000, 1.9}));
  LinePace slow;
  EXPECT_FALSE(slow.due({1, 1000, 4.9}));
  EXPECT_TRUE(slow.due({1, 1000, 5}));  // the first tells how long it will take
  EXPECT_FALSE(slow.due({2, 1000, 64}));
  EXPECT_TRUE(slow.due({2, 1000, 65}));
}

}  // namespace
}  // namespace gliss
