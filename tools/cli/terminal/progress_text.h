// The words of a progress display, and when they are due: no clock and no terminal in here.
#pragma once

#include <cstdint>
#include <string>

namespace gliss::tools {

struct ProgressState {
  std::uint64_t done = 0;
  std::uint64_t total = 0;  // 0: unknown
  double seconds = 0;       // since the start
};

std::string count_text(double count);       // "950", "12.3 k", "4.56 M", "1.20 G"
std::string duration_text(double seconds);  // "0.8 s", "42 s", "3:07 min", "2:15 h"

// "43 %  1.20 M of 2.80 M points  312 k/s  5.1 s left"; before there is a
// rate "0 %  0 of 2.80 M points  5.1 s so far"; nothing counted: "5.1 s".
std::string progress_text(const ProgressState& state, const std::string& noun);
std::string finished_text(const ProgressState& state, const std::string& noun);
std::string progress_bar(const ProgressState& state,
                         int width);  // "[####------]"; empty: total unknown

// Plain lines in a log: at least 2 s apart, and then each 10 % or each minute, whatever comes
// first; the first of them after 5 s.
class LinePace {
 public:
  bool due(const ProgressState& state);

 private:
  double last_seconds_ = 0;
  double last_fraction_ = 0;
};

}  // namespace gliss::tools
