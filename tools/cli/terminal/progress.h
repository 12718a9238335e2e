// Progress of a long command on stderr: a bar on a terminal, now and then a line in a log, or
// nothing.
#pragma once

#include <cstdint>
#include <string>

#include "gliss/base/stopwatch.h"
#include "tools/cli/terminal/progress_text.h"
#include "tools/cli/terminal/status_line.h"

namespace gliss::tools {

enum class ProgressStyle { kAutomatic, kSilent };

// One thread updates it, as often as it likes: most calls read the clock and return.
class Progress {
 public:
  // total = 0: unknown. `noun` is what is counted, in the plural: "points".
  Progress(std::string label, std::uint64_t total, std::string noun,
           ProgressStyle style = ProgressStyle::kAutomatic);

  void update(std::uint64_t done);
  // Says how many in what time; in a log only what took half a second.
  void finish();

 private:
  std::string label_, noun_;
  StatusLine line_;
  ProgressState state_;
  LinePace pace_;
  double drawn_ = -1;  // when the bar was drawn last; negative: never
  Stopwatch clock_;
};

}  // namespace gliss::tools
