// Finished parts of long work in a folder, so that work that was stopped or killed at whatever
// moment goes on where it was, and processes share it.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Names the next part to do, from 0 on, each beyond the one before. The first that is not there,
// because its number is the number of parts or more, is the end. It may take its time, and throw.
using PartSource = std::function<std::size_t()>;
// The parts `first`, first + step, first + 2 step ...: a shard of `step` that share the work.
GLISS_EXPORT PartSource every_part(std::size_t first = 0, std::size_t step = 1);

// Told how much of the work stands before what is being done, in its order, whoever did it; several
// times a second. What it throws ends the work.
using PartProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;

// Who else may work in the folder meanwhile.
enum class PartsAccess {
  kAlone,   // nobody: for work that removes the parts in the end
  kShared,  // whoever shares it: for shards
};

// The bytes of a part's file: a header, which PartFolder fills in, and behind it the data of the
// work.
struct PartFile {
  static constexpr std::size_t kHeaderBytes = 24;
  std::string bytes = std::string(kHeaderBytes, '\0');

  std::string_view body() const { return std::string_view(bytes).substr(kHeaderBytes); }
};

// Hash of all in a cache that contacts depend on.
GLISS_EXPORT std::uint64_t surface_hash(const PatchCache& cache);
// Hash of a surface, of the revision of the numbers (gliss/surface/revision.h) and of the form of
// parts; `told`: all else that the parts of some work depend on.
GLISS_EXPORT std::uint64_t work_hash(std::uint64_t surface, const std::string& told);

// Closes it in the end.
class OwnedDescriptor {
 public:
  explicit OwnedDescriptor(int descriptor = -1) : descriptor_(descriptor) {}
  ~OwnedDescriptor() { set(-1); }
  OwnedDescriptor(const OwnedDescriptor&) = delete;
  OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;

  operator int() const { return descriptor_; }  // below 0: none
  void set(int descriptor) noexcept;            // closes the one before

 private:
  int descriptor_;
};

// A part is a file of its own that is there as a whole or not at all, with a checksum. Its name
// says of which work it is, by a hash. What is of other work, or damaged, is never read, and what
// is of other work stays. Failures of files throw std::system_error. For one thread, but that
// another one may save() parts meanwhile.
class GLISS_EXPORT PartFolder {
 public:
  // Creates the folder where it is not there, for this user alone. Throws std::runtime_error where
  // another process works in it that does not share it, and where others could leave parts: in what
  // is no folder but a link to one, and in folders that belong to another user or that all may
  // write to. `hash`: of the work (work_hash).
  PartFolder(const std::string& folder, std::uint64_t hash,
             PartsAccess access = PartsAccess::kAlone);
  // Removes the folder if it is empty, was made for parts and is not shared.
  ~PartFolder();
  PartFolder(const PartFolder&) = delete;
  PartFolder& operator=(const PartFolder&) = delete;

  const std::string& folder() const { return folder_; }
  std::uint64_t hash() const { return hash_; }      // of the work
  std::size_t kept() const { return kept_; }        // parts that are there, as far as is known
  std::size_t foreign() const { return foreign_; }  // files of other work
  const std::vector<std::string>& damaged() const { return damaged_; }  // files met so far
  // True if the part is there by now, by its header alone.
  bool is_whole(std::size_t part) const;
  std::size_t whole() const;  // how many are
  // Returns the first bytes of the body of a whole part, unchecked; "" where it is not whole.
  std::string head(std::size_t part, std::size_t bytes) const;

  // Nothing where the part is not there or is damaged; then it is removed.
  std::optional<PartFile> load(std::size_t part);
  // Removes a part that was loaded and turned out to be damaged.
  void discard(std::size_t part);
  // Fills in the header and saves.
  void save(std::size_t part, PartFile& file);

  // Removes all parts of this work: its result is safe elsewhere. Where the folder is shared they
  // stay, and it is false, unless nobody else has it by now.
  bool remove();

  // Leaves a mark in the folder, looks for it, and removes it: for processes that must know whether
  // their folders of one name are one folder.
  void leave_mark(std::uint64_t mark) const;
  bool has_mark(std::uint64_t mark) const;
  void remove_mark(std::uint64_t mark) const;

 private:
  void open_folder();
  bool open_once();
  void mark_as_made() const;
  std::optional<PartFile> read(std::size_t part) const;
  std::string path_of(std::size_t part) const;
  std::string path_of_mark(std::uint64_t mark) const;
  [[noreturn]] void fail(const char* action) const;
  [[noreturn]] void refuse(const char* why) const;

  const std::uint64_t hash_;
  std::string folder_, key_;  // the hash, which the names of its files begin with
  PartsAccess access_;
  OwnedDescriptor lock_;
  std::atomic<std::size_t> kept_ = 0;
  std::size_t foreign_ = 0;
  std::vector<std::string> damaged_;
};

}  // namespace gliss
