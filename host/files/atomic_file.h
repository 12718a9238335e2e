// Whole files that appear complete or not at all: written beside their place, synced, then renamed
// over it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "gliss/base/export.h"

namespace gliss {

// A killed or failing writer leaves whatever stood at the path before. Every failure, a full disk
// as well, throws std::system_error that names the file. Several writers of one path never mix: the
// last commit wins. What a killed writer leaves beside the path, path.gliss-tmp0, the next one
// removes; a long name is cut (with_ending).
class GLISS_EXPORT AtomicFile {
 public:
  // Creates the temporary, so that a missing or read-only folder is reported before any work is
  // done. A symbolic link is followed; devices, pipes and folders are refused. A file that is
  // replaced keeps its permissions; `mode` and the umask are those of a new one.
  explicit AtomicFile(const std::string& path, unsigned mode = 0666);
  ~AtomicFile();  // without commit() the temporary is removed and the path left as it was
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(const void* data, std::size_t size);
  void write(std::string_view text) { write(text.data(), text.size()); }

  // An empty file, for libraries that open by name: they must fill it in place and close it before
  // commit().
  const std::string& temporary_path() const { return temporary_; }
  // Lets the disk begin with what is there, so that commit() waits for less.
  void start_sync() const;
  const std::string& path() const { return path_; }  // as given, for messages

  void commit();  // the file is now in place, on disk; nothing may follow

 private:
  void flush();
  [[noreturn]] void fail(const char* action) const;

  std::string path_, target_, temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

// The path with an ending. A last name that would be too long with it is cut to what file systems
// take, 255 bytes, and told from others by a hash.
GLISS_EXPORT std::string with_ending(const std::string& path, const std::string& ending);

}  // namespace gliss
