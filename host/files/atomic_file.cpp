#include "gliss/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <filesystem>
#include <random>
#include <string_view>
#include <system_error>
#include <utility>

#include "gliss/base/utf8.h"

namespace gliss {
namespace {

constexpr std::size_t kBufferSize = 1 << 18;

constexpr int kNamedTemporaries = 8, kMostTemporaries = 100;

// A writer holds a lock on its temporary as long as it lives, on whatever machine of a share.
// Beyond some numbers, taken where files cannot be locked, dice are thrown.
std::string temporary_name(const std::string& target, int number) {
  return with_ending(target,
                     number < kNamedTemporaries
                         ? fmt::format(".gliss-tmp{}", number)
                         : fmt::format(".gliss-tmp{}-{:08x}", getpid(), std::random_device{}()));
}

template <class Call>
int repeated(const Call& call) {
  int result = 0;
  do result = call();
  while (result < 0 && errno == EINTR);
  return result;
}

bool lock(int descriptor) {
  return repeated([&] { return flock(descriptor, LOCK_EX | LOCK_NB); }) == 0;
}

// Created and locked; -1 where that name is taken, or cannot be created (errno).
int create_temporary(const std::string& name, unsigned mode) {
  const int descriptor =
      repeated([&] { return open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode); });
  if (descriptor < 0) return descriptor;
  struct stat status {};
  const bool taken = !lock(descriptor) && errno == EWOULDBLOCK;
  if (!taken && fstat(descriptor, &status) != 0) {
    const int error = errno;
    unlink(name.c_str());
    close(descriptor);
    errno = error;
    return -1;
  }
  if (!taken && status.st_nlink > 0) return descriptor;
  close(descriptor);  // whoever removes what the dead leave was quicker than the lock
  errno = EEXIST;
  return -1;
}

// Removes a killed writer's temporary. The writer of another still holds its lock, and that file is
// left alone.
void remove_stale(const std::string& name) {
  const int descriptor =
      repeated([&] { return open(name.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC); });
  if (descriptor < 0) return;
  struct stat locked {
  }, named{};
  const bool stale = lock(descriptor) && fstat(descriptor, &locked) == 0 &&
                     lstat(name.c_str(), &named) == 0 && S_ISREG(named.st_mode) &&
                     locked.st_dev == named.st_dev && locked.st_ino == named.st_ino;
  if (stale) unlink(name.c_str());
  close(descriptor);
}

std::string folder_of(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

std::string with_ending(const std::string& path, const std::string& ending) {
  constexpr std::size_t kLongestName = 255;
  const std::size_t begin = path.rfind('/') + 1;  // 0 where there is none
  const std::string_view name = std::string_view(path).substr(begin);
  if (name.size() + ending.size() <= kLongestName) return path + ending;
  const std::string tail = fmt::format("~{:016x}{}", XXH3_64bits(name.data(), name.size()), ending);
  return path.substr(0, begin).append(cut_text(name, kLongestName - tail.size())) + tail;
}

AtomicFile::AtomicFile(const std::string& path, unsigned mode) : path_(path), target_(path) {
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
  if (!replaces && errno == ENAMETOOLONG) fail("cannot create");  // that of the temporary may fit
  if (replaces && !S_ISREG(old.st_mode)) {
    errno = S_ISDIR(old.st_mode) ? EISDIR : EINVAL;
    fail(S_ISDIR(old.st_mode) ? "cannot write" : "not a regular file, cannot replace");
  }
  for (int number = 0; number < kNamedTemporaries; ++number) {
    remove_stale(temporary_name(target_, number));
  }
  for (int number = 0; descriptor_ < 0; ++number) {
    temporary_ = temporary_name(target_, number);
    descriptor_ = create_temporary(temporary_, mode);
    if (descriptor_ < 0 && (errno != EEXIST || number == kMostTemporaries)) fail("cannot create");
  }
  // A replaced file keeps its permissions; where that is not allowed the umask decides, as for a
  // new file.
  if (replaces) (void)!fchmod(descriptor_, old.st_mode & 07777);
}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) unlink(temporary_.c_str());  // while it is locked, so that it is ours
  if (descriptor_ >= 0) close(descriptor_);
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

void AtomicFile::start_sync() const {
  (void)!sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE);  // advice: commit() syncs
}

void AtomicFile::commit() {
  const std::string parent = folder_of(target_);  // what may fail for want of memory comes first
  flush();
  if (repeated([&] { return fsync(descriptor_); }) != 0) fail("cannot sync");
  if (rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot rename the temporary of");
  temporary_.clear();
  close(std::exchange(descriptor_, -1));  // what was written has been synced
  const int folder =
      repeated([&] { return open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); });
  if (folder < 0) fail("cannot open the folder of");
  const int synced = repeated([&] { return fsync(folder); }) == 0 ? 0 : errno;
  close(folder);
  errno = synced;
  if (synced != 0 && synced != EINVAL) fail("cannot sync the folder of");  // EINVAL: it has no sync
}

void AtomicFile::fail(const char* action) const {
  const int error = errno;  // before anything can change it
  throw std::system_error(error, std::generic_category(), fmt::format("{} '{}'", action, path_));
}

}  // namespace gliss
