#include "host/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

namespace gliss {
namespace {

constexpr std::size_t kBufferSize = 1 << 18;

// Unique among threads by the counter, among processes by the id, among machines of one share by
// the dice. O_EXCL has the last word.
std::string temporary_name(const std::string& target) {
  static std::atomic<unsigned> counter{0};
  return fmt::format("{}.tmp{}-{}-{:08x}", target, getpid(), counter++, std::random_device{}());
}

std::string folder_of(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path), target_(path) {
  if (path.empty()) {
    errno = ENOENT;
    fail("cannot create");
  }
  std::error_code no_link;
  if (std::filesystem::is_symlink(path, no_link)) {
    target_ = std::filesystem::weakly_canonical(path).string();
  }
  struct stat old {};
  const bool replaces = stat(target_.c_str(), &old) == 0;
  if (replaces && !S_ISREG(old.st_mode)) {
    errno = S_ISDIR(old.st_mode) ? EISDIR : EINVAL;
    fail(S_ISDIR(old.st_mode) ? "cannot write" : "not a regular file, cannot replace");
  }
  do {
    temporary_ = temporary_name(target_);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
  if (descriptor_ < 0) fail("cannot create");
  // A replaced file keeps its permissions; where that is not allowed the umask decides, as for a
  // new file.
  if (replaces) (void)!fchmod(descriptor_, old.st_mode & 07777);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(const void* data, std::size_t size) {
  if (buffer_.capacity() < kBufferSize) buffer_.reserve(kBufferSize);
  const char* bytes = static_cast<const char*>(data);
  if (buffer_.size() + size > kBufferSize) flush();
  while (size > kBufferSize) {  // in pieces, so that a big block needs no second copy of itself
    buffer_.assign(bytes, kBufferSize);
    flush();
    bytes += kBufferSize;
    size -= kBufferSize;
  }
  buffer_.append(bytes, size);
}

void AtomicFile::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t count = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (count < 0 && errno != EINTR) fail("cannot write");
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  flush();
  if (fsync(descriptor_) != 0) fail("cannot sync");
  const int closing = std::exchange(descriptor_, -1);
  if (close(closing) != 0) fail("cannot close");
  if (rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot rename the temporary of");
  temporary_.clear();
  const int folder = open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) fail("cannot open the folder of");
  const int synced = fsync(folder) == 0 ? 0 : errno;
  close(folder);
  errno = synced;
  if (synced != 0 && synced != EINVAL) fail("cannot sync the folder of");  // EINVAL: it has no sync
}

void AtomicFile::fail(const char* action) const {
  const int error = errno;  // before anything can change it
  throw std::system_error(error, std::generic_category(), fmt::format("{} '{}'", action, path_));
}

}  // namespace gliss
