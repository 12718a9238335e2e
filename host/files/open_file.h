// The one way in which inputs are opened: regular files, which have an end and wait for nobody.
#pragma once

#include <fcntl.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "gliss/base/export.h"
#include "gliss/base/large_array.h"

namespace gliss {

// An input that is no regular file, or a large one nearly nothing of which was ever written: what()
// names it.
struct GLISS_EXPORT NoFileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A descriptor of a regular file that closes itself. Pipes, devices and sockets are not opened:
// they may have no end, or wait for another program.
class GLISS_EXPORT OpenFile {
 public:
  // flags of open(2).
  explicit OpenFile(const std::string& path, int flags = O_RDONLY);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int descriptor() const { return descriptor_; }  // below 0: not open
  std::uint64_t size() const { return size_; }    // bytes, when it was opened
  std::string why() const;                        // it is not open, or cannot be read

  // Throws NoFileError, or std::system_error "cannot read 'path': why".
  void check() const;
  [[noreturn]] void fail() const;

  // Reads what is left, at most so many bytes; fewer only at the end of the file. Throws as fail().
  std::size_t read(void* to, std::size_t bytes);
  // The same from a place of the file, wherever read() is.
  std::size_t read_at(std::uint64_t at, void* to, std::size_t bytes);
  // Reads all that is left; hands it to `each_block` whenever a block has been added.
  LargeArray<char> read_all(
      const std::function<void(std::string_view so_far)>& each_block = nullptr);

 private:
  template <class Read>
  std::size_t read_by(void* to, std::size_t bytes, const Read& read);

  std::string path_;
  int descriptor_ = -1, error_ = 0;
  const char* kind_ = nullptr;  // of what is no regular file
  std::uint64_t size_ = 0;
  bool is_hollow_ = false;
};

}  // namespace gliss
