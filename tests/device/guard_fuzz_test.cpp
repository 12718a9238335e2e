// Holds the guards' promises after any step, whatever the input: 1e6 steps, 1e8 with
// GLISS_LONG_TESTS.
#include "tests/device/guard_fuzz.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace gliss {
namespace {

TEST(GuardFuzz, holds_its_promises_whatever_the_input) {
  const std::uint64_t steps = std::getenv("GLISS_LONG_TESTS") ? 100'000'000 : 1'000'000;
  const GuardLimits limits{.max_force = 3, .max_rate = 400};
  Guard guard(limits);
  test::GuardJudge judge(limits);
  test::GuardFuzz fuzz(31);
  std::array<std::uint64_t, 5> seen{};
  std::uint64_t violations = 0;
  for (std::uint64_t i = 1; i <= steps; ++i) {
    fuzz.next();
    if (fuzz.trip != GuardReason::kNone) guard.trip(fuzz.trip);
    const GuardOutput out = guard.step(fuzz.now, {fuzz.force, fuzz.measured});
    ++seen[static_cast<std::size_t>(out.state)];
    if (!judge.sound(fuzz, out) && ++violations <= 5) {
      ADD_FAILURE() << "step " << i << ": " << guard_state_name(out.state) << ", "
                    << guard_reason_name(out.reason) << ", " << out.force.transpose()
                    << " N, wanted " << fuzz.force.transpose();
    }
    if (i % 8 == 0 && guard.engage()) {
      EXPECT_LT(fuzz.force.norm(), limits.engage_below);
      EXPECT_TRUE(out.state == GuardState::kSafe);
      judge.engaged();
    }
    if (i % 2'000 == 0) {  // a new start
      guard = Guard(limits);
      judge = test::GuardJudge(limits);
    }
  }
  EXPECT_EQ(violations, 0u);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_GE(seen[i], steps / 200) << guard_state_name(static_cast<GuardState>(i));
  }
}

}  // namespace
}  // namespace gliss
