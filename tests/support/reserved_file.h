// Large files that take no time to write.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace gliss::test {

// Makes a file longer by zeros that have their place on disk, unlike a hole, and are not written.
// False where there is no place.
inline bool reserve(const std::string& path, std::int64_t size) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  const bool reserved = file >= 0 && posix_fallocate(file, 0, size) == 0;
  if (file >= 0) close(file);
  return reserved;
}

}  // namespace gliss::test
