// Files that somebody edits meanwhile.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gliss::tools {

// Tells that files have changed. One thread's.
class WatchedFiles {
 public:
  // Watches these from now on; what they are now is no change.
  void watch(const std::vector<std::string>& paths);
  // True, once, if a file is another than when they were watched, and the same as in the call
  // before: whoever writes it has paused. A file that is not there has not changed.
  bool changed();

 private:
  struct Stamp {
    std::filesystem::file_time_type time;
    std::uintmax_t size = 0;
    bool operator==(const Stamp&) const = default;
  };
  std::vector<Stamp> stamps() const;

  std::vector<std::string> paths_;
  std::vector<Stamp> known_, last_;  // [paths_]
};

}  // namespace gliss::tools
