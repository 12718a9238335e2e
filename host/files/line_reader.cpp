#include "gliss/files/line_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace gliss {
namespace {

constexpr std::size_t kBlockSize = 1 << 20;

}  // namespace

LineReader::LineReader(const std::string& path, Poll poll)
    : path_(path), file_(path), poll_(std::move(poll)), block_(kBlockSize) {
  file_.check();
}

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
  poll_();
  const std::size_t count = file_.read(block_.data() + end_, block_.size() - end_);
  end_ += count;
  return count > 0;
}

}  // namespace gliss
