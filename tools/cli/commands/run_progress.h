// Tells on stderr how far gliss run has come: the loop's figures where it keeps a clock, else as
// any long work.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "tools/cli/commands/run_report.h"
#include "tools/cli/terminal/progress.h"

namespace gliss::tools {

class RunProgress {
 public:
  // total: ticks without a clock; 0: unknown.
  RunProgress(bool quiet, bool no_wait, std::uint64_t total);

  // Shows the ticks so far; it may be called as often as one likes.
  void update(RunReport& report, std::uint64_t ticks);
  void finish(RunReport& report, std::uint64_t ticks);
  void say(const std::string& text);  // a line of its own

 private:
  void show(RunReport& report) { line_->show(report.live_line()); }

  bool quiet_, no_wait_;
  std::uint64_t total_;
  std::optional<StatusLine> line_;
  std::chrono::milliseconds pace_;
  std::chrono::steady_clock::time_point next_;
  Progress progress_;
  Stopwatch clock_;
};

}  // namespace gliss::tools
