#include "gliss/files/open_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace gliss {
namespace {

constexpr std::size_t kBlock = 1 << 20;

// Null for regular files, and for folders, which have an error of their own.
const char* kind_of(mode_t mode) {
  if (S_ISREG(mode) || S_ISDIR(mode)) return nullptr;
  return S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : "a device";
}

// True if nearly nothing of a large file was ever written: the rest would be read as zeros, for
// hours. Compressed files have few blocks as well, but no holes.
bool is_hollow(int descriptor, const struct stat& status) {
  constexpr off_t kLarge = 64 << 20, kShare = 64;  // bytes; of the size that is to be stored
  const off_t size = status.st_size, enough = size / kShare;
  if (size < kLarge || static_cast<off_t>(status.st_blocks) * 512 >= enough) return false;
  off_t stored = 0;
  for (off_t data, hole = 0; stored < enough; stored += hole - data) {
    data = lseek(descriptor, hole, SEEK_DATA);
    hole = data < 0 ? -1 : lseek(descriptor, data, SEEK_HOLE);
    if (hole < 0) break;
  }
  lseek(descriptor, 0, SEEK_SET);
  return stored < enough;
}

}  // namespace

// Looks first, since opening a device may do something, and again at what was opened.
OpenFile::OpenFile(const std::string& path, int flags) : path_(path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    error_ = errno;
    return;
  }
  kind_ = kind_of(status.st_mode);
  if (kind_ != nullptr) return;
  descriptor_ = open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) {
    error_ = errno;
  } else if (S_ISDIR(status.st_mode)) {
    error_ = EISDIR;
  } else {
    kind_ = kind_of(status.st_mode);
    size_ = static_cast<std::uint64_t>(status.st_size);
    is_hollow_ = kind_ == nullptr && is_hollow(descriptor_, status);
    if (kind_ == nullptr && !is_hollow_) return;
  }
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::string OpenFile::why() const {
  constexpr const char* kCure = "write what comes out of it to a file, and name that";
  if (kind_ != nullptr)
    return fmt::format("it is {}, and only regular files are read; {}", kind_, kCure);
  if (is_hollow_)
    return fmt::format("it says to have {} bytes, of which nearly none were ever written", size_);
  if (error_ == ENOENT && path_ == "-") return fmt::format("standard input is not read; {}", kCure);
  return std::strerror(error_);
}

void OpenFile::check() const {
  if (descriptor_ < 0) fail();
}

void OpenFile::fail() const {
  const std::string action = fmt::format("cannot read '{}'", path_);
  if (kind_ != nullptr || is_hollow_) throw NoFileError(fmt::format("{}: {}", action, why()));
  throw std::system_error(error_, std::generic_category(), action);
}

// read(to, bytes, done): reads more, behind what is done.
template <class Read>
std::size_t OpenFile::read_by(void* to, std::size_t bytes, const Read& read) {
  std::size_t done = 0;
  while (done < bytes) {
    const ssize_t count = read(static_cast<char*>(to) + done, bytes - done, done);
    if (count == 0) break;
    if (count > 0) {
      done += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      error_ = errno;
      fail();
    }
  }
  return done;
}

std::size_t OpenFile::read(void* to, std::size_t bytes) {
  return read_by(to, bytes,
                 [&](char* at, std::size_t rest, auto) { return ::read(descriptor_, at, rest); });
}

std::size_t OpenFile::read_at(std::uint64_t at, void* to, std::size_t bytes) {
  return read_by(to, bytes, [&](char* next, std::size_t rest, std::size_t done) {
    return pread(descriptor_, next, rest, static_cast<off_t>(at + done));
  });
}

LargeArray<char> OpenFile::read_all(const std::function<void(std::string_view)>& each_block) {
  check();
  const std::uint64_t file_size = size();
  LargeArray<char> text;
  for (std::size_t got = kBlock; got == kBlock;) {
    const std::size_t old = text.size();
    if (text.capacity() < old + kBlock) {
      // A file's size is believed as far as some of it has come: it may be a large hole.
      const std::size_t rest = std::min<std::uint64_t>(file_size + kBlock, 8 * old);
      text.reserve(std::max(2 * old + kBlock, rest));
    }
    text.resize(old + kBlock);
    got = read(text.data() + old, kBlock);
    text.resize(old + got);
    if (each_block) each_block({text.data(), text.size()});
  }
  return text;
}

}  // namespace gliss
