#include "tools/view/watched_files.h"

namespace gliss::tools {

void WatchedFiles::watch(const std::vector<std::string>& paths) {
  paths_ = paths;
  known_.assign(paths.size(), {});
  known_ = last_ = stamps();
}

bool WatchedFiles::changed() {
  const std::vector<Stamp> now = stamps();
  const bool is_new = now != known_ && now == last_;
  last_ = now;
  if (is_new) known_ = now;
  return is_new;
}

std::vector<WatchedFiles::Stamp> WatchedFiles::stamps() const {
  std::vector<Stamp> all;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    std::error_code gone;
    const auto time = std::filesystem::last_write_time(paths_[i], gone);
    const auto size = gone ? 0 : std::filesystem::file_size(paths_[i], gone);
    all.push_back(gone ? known_[i] : Stamp{time, size});
  }
  return all;
}

}  // namespace gliss::tools
