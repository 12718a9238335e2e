// Measures how long work goes on without a word: Ctrl-C is answered where work asks whether it is
// to stop.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "gliss/thread/clock.h"

namespace gliss::test {

// Processor time of the calling thread, which other programs do not lengthen, as they do a wait.
class PollGap {
 public:
  // Ctrl-C is answered within half a second (docs/safety.md).
  static constexpr std::chrono::milliseconds kPromised{500};

  void poll() {
    const Nanoseconds now = thread_time();
    longest_ = std::max(longest_, now - last_);
    last_ = now;
  }
  // From the last poll to the end, too.
  void expect_promised() {
    poll();
    EXPECT_LE(longest_, kPromised);
  }

 private:
  Nanoseconds last_ = thread_time(), longest_{};
};

}  // namespace gliss::test
