// A text file line by line, of which only one block is ever in memory.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/files/open_file.h"

namespace gliss {

inline constexpr std::size_t kLongestLine = 1 << 24;  // bytes; what has longer ones is no text

// Throws as OpenFile does where the file cannot be read, std::runtime_error on a line without end.
class GLISS_EXPORT LineReader {
 public:
  explicit LineReader(const std::string& path, Poll poll = {});

  // The next line without its LF or CRLF, valid until the next call; false after the last.
  bool next(std::string_view& line);

  std::size_t line_number() const { return line_number_; }  // of the line given last, from 1
  std::size_t bytes_read() const { return bytes_read_; }    // up to its end
  std::size_t file_size() const { return file_.size(); }

 private:
  bool refill();

  std::string path_;
  OpenFile file_;
  Poll poll_;
  std::vector<char> block_;
  std::size_t begin_ = 0, end_ = 0;  // of block_: what is not given yet
  std::size_t line_number_ = 0, bytes_read_ = 0;
};

}  // namespace gliss
