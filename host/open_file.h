// A file descriptor that closes itself.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <string>

namespace gliss {

struct OpenFile {
  // flags of open(2); not blocked by a pipe that nobody writes to. A descriptor below 0, and errno,
  // where it cannot be opened.
  explicit OpenFile(const std::string& path, int flags = O_RDONLY)
      : descriptor(open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK)) {}
  ~OpenFile() {
    if (descriptor >= 0) close(descriptor);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  const int descriptor;
};

}  // namespace gliss
