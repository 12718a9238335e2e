// Judges whether a machine is fit for the loop, by what a loop with a real tick recorded, against
// the same loop with nothing in it.
#pragma once

#include "gliss/base/export.h"
#include "gliss/thread/timing.h"

namespace gliss {

struct LoopGoals {
  Nanoseconds wake;     // p99.9 of the wake's lateness
  Nanoseconds compute;  // p99
  double success;       // of all periods
};

// A tick that is no part of the trouble: `wake` is beyond the empty loop's. And whoever is to
// blame, wakes are at most half a period late: kLatestGoodWake.
inline constexpr LoopGoals kGood = {std::chrono::microseconds(50), std::chrono::microseconds(50),
                                    0.999};
inline constexpr Nanoseconds kLatestGoodWake = std::chrono::microseconds(500);
// A wake later than 2 ms makes the loop hold its force; half a period is left for the device.
inline constexpr LoopGoals kUsable = {std::chrono::milliseconds(2), std::chrono::microseconds(500),
                                      0.99};

enum class Verdict { kGood, kUsable, kUnfit };
GLISS_EXPORT const char* verdict_name(Verdict verdict);  // "good", "usable", "unfit"

// A loop without a tick is unfit.
GLISS_EXPORT Verdict judge(const TickRecord& floor, const TickRecord& loop);

}  // namespace gliss
