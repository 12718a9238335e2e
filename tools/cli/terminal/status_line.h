// One line on stderr that is drawn over and over on a terminal, and lines in a log.
#pragma once

#include <string>

namespace gliss::tools {

class StatusLine {
 public:
  enum class Place { kTerminal, kLog, kNowhere };

  explicit StatusLine(bool silent);
  ~StatusLine();  // what stands there stays, and the next output has a line of its own
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  Place place() const { return place_; }
  void show(const std::string& text);
  void finish(const std::string& text);  // the last

 private:
  Place place_;
  bool open_ = false;  // the text stands on the terminal's last line
};

}  // namespace gliss::tools
