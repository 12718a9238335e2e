// Long work under way: progress once nothing was said for half a second, and Ctrl-C.
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <string>

#include "tools/cli/terminal/answer.h"
#include "tools/cli/terminal/progress.h"

namespace gliss::tools {

// Answers Ctrl-C with the exception Interrupted, and lets the bar of the latest Watch move: for
// what asks now and then, from any thread.
void stop_if_interrupted();

// Ctrl-C is answered with the exception Interrupted, out of add() or reach(). One that is made
// while another is there ends before that.
class Watch {
 public:
  // total = 0: how much there is to do is not known.
  Watch(const ReportOptions& options, std::string label, std::uint64_t total = 0,
        std::string noun = "");
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  void add(std::uint64_t more);    // from any thread
  void reach(std::uint64_t done);  // from one

 private:
  friend void stop_if_interrupted();
  void draw();  // under the lock

  Watch* outer_;
  Progress progress_;
  std::uint64_t done_ = 0, total_;
  bool shown_ = false;
  const int unwinding_ = std::uncaught_exceptions();
};

// Calls body(begin, end, watch) over [0, count) in blocks that bound the memory of the results.
template <class Body>
void for_blocks(const ReportOptions& options, const std::string& label, std::size_t count,
                const std::string& noun, Body body) {
  constexpr std::size_t kBlock = 65536;
  Watch watch(options, label, count, noun);
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t end = std::min(count, begin + kBlock);
    body(begin, end, watch);
    watch.reach(end);
  }
}

}  // namespace gliss::tools
