#include "host/line_reader.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace gliss {
namespace {

constexpr std::size_t kBlockSize = 1 << 20;
constexpr std::size_t kLongestLine = 1 << 24;

[[noreturn]] void fail(const std::string& path) {
  const int error = errno;  // before anything can change it
  throw std::system_error(error, std::generic_category(), fmt::format("cannot read '{}'", path));
}

}  // namespace

LineReader::LineReader(const std::string& path) : path_(path), block_(kBlockSize) {
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail(path);
  struct stat status {};
  if (fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)) {
    file_size_ = static_cast<std::size_t>(status.st_size);
  }
}

LineReader::~LineReader() { close(descriptor_); }

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;  // a line longer than what is loaded is not searched twice
  const void* end = nullptr;
  do {
    const char* begin = block_.data() + begin_;
    end = std::memchr(begin + searched, '\n', end_ - begin_ - searched);
    searched = end_ - begin_;
  } while (!end && refill());
  if (!end && begin_ == end_) return false;
  const char* begin = block_.data() + begin_;
  const std::size_t size = end ? static_cast<const char*>(end) - begin : end_ - begin_;
  line = {begin, size};
  if (line.ends_with('\r')) line.remove_suffix(1);
  begin_ += size + (end ? 1 : 0);
  bytes_read_ += size + (end ? 1 : 0);
  ++line_number_;
  return true;
}

// Moves the rest to the front and reads behind it; false at the end of the file.
bool LineReader::refill() {
  std::copy(block_.begin() + begin_, block_.begin() + end_, block_.begin());
  end_ -= std::exchange(begin_, 0);
  if (end_ == block_.size()) {
    if (end_ > kLongestLine) {
      throw std::runtime_error(fmt::format("{}:{}: a line of over {} bytes, not a text file?",
                                           path_, line_number_ + 1, kLongestLine));
    }
    block_.resize(2 * end_);
  }
  ssize_t count = 0;
  do {
    count = read(descriptor_, block_.data() + end_, block_.size() - end_);
  } while (count < 0 && errno == EINTR);
  if (count < 0) fail(path_);
  end_ += static_cast<std::size_t>(count);
  return count > 0;
}

}  // namespace gliss
