// Long work under way: progress once it has taken a second, and Ctrl-C.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "tools/cli/command.h"
#include "tools/cli/progress.h"

namespace gliss::tools {

// Answers Ctrl-C with the exception Interrupted: for what asks now and then.
void stop_if_interrupted();

// Ctrl-C is answered with the exception Interrupted, out of add() or reach().
class Watch {
 public:
  Watch(const ReportOptions& options, std::string label, std::uint64_t total, std::string noun);
  ~Watch();

  void add(std::uint64_t more);    // from any thread
  void reach(std::uint64_t done);  // from one

 private:
  std::mutex mutex_;
  Progress progress_;
  Stopwatch clock_;
  std::uint64_t done_ = 0, total_;
  bool shown_ = false;
};

// The size of pieces that take about a tenth of a second: from one item on, it doubles or halves.
class Pace {
 public:
  // Calls body(begin, end) over [0, count) in such pieces; Ctrl-C is answered between them.
  template <class Body>
  void for_pieces(std::size_t count, Body body) {
    for (std::size_t begin = 0; begin < count;) {
      stop_if_interrupted();
      const std::size_t end = begin + std::min(size_, count - begin);
      const Stopwatch clock;
      body(begin, end);
      const double seconds = clock.seconds();
      if (seconds < 0.05 && end - begin == size_) size_ *= 2;
      if (seconds > 0.2) size_ = std::max<std::size_t>(1, size_ / 2);
      begin = end;
    }
  }

 private:
  std::size_t size_ = 1;
};

// Calls body(begin, end) over [0, count) in blocks that bound the memory of the results.
template <class Body>
void for_blocks(const ReportOptions& options, const std::string& label, std::size_t count,
                const std::string& noun, Body body) {
  constexpr std::size_t kBlock = 65536;
  Watch watch(options, label, count, noun);
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t end = std::min(count, begin + kBlock);
    body(begin, end);
    watch.reach(end);
  }
}

}  // namespace gliss::tools
