#include "gliss/sweep/part_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

#include "gliss/files/atomic_file.h"
#include "gliss/files/cache_format.h"
#include "gliss/files/open_file.h"
#include "gliss/surface/revision.h"

namespace gliss {
namespace {

constexpr std::uint32_t kPartFormat = 7;
constexpr std::string_view kMagic = "GLSPART\n", kEnding = ".part";
// An empty file in a folder that was made for parts: work that goes on may remove such a folder in
// the end, and no other.
constexpr const char* kMadeForParts = ".gliss-parts";

struct PartHeader {
  char magic[8];
  std::uint64_t checksum;  // of all that follows
  std::uint64_t part;
};
static_assert(sizeof(PartHeader) == PartFile::kHeaderBytes);

std::uint64_t checksum_of(const std::string& bytes) {
  constexpr std::size_t kChecked = offsetof(PartHeader, part);
  return cache_format::checksum(bytes.data() + kChecked, bytes.size() - kChecked);
}

// A part that is open. Throws std::runtime_error for one that another user could have written: in a
// folder that a group may write to, say.
class OpenPart : public OpenFile {
 public:
  explicit OpenPart(const std::string& path) : OpenFile(path, O_RDONLY | O_NOFOLLOW) {
    struct stat status {};
    if (descriptor() < 0 || fstat(descriptor(), &status) != 0) return;
    const char* fault = status.st_uid != geteuid()                    ? "belongs to another user"
                        : (status.st_mode & (S_IWGRP | S_IWOTH)) != 0 ? "may be written by others"
                                                                      : nullptr;
    if (fault != nullptr)
      throw std::runtime_error(
          fmt::format("'{}' {}; remove it, or name another folder", path, fault));
  }
};

// The checksum is left to who reads the part.
bool read_header(OpenFile& opened) {
  PartHeader header{};
  return opened.descriptor() >= 0 && opened.read(&header, sizeof header) == sizeof header;
}
bool has_header(const std::string& path) {
  OpenPart opened(path);
  return read_header(opened);
}

// Calls each(name) for what is in a folder; false where that cannot be read. The library's iterator
// ends the process where memory ends.
template <class Each>
bool for_each_name(const std::string& folder, const Each& each) {
  const std::unique_ptr<DIR, int (*)(DIR*)> opened(opendir(folder.c_str()), closedir);
  if (opened == nullptr) return false;
  while (const dirent* file = readdir(opened.get())) {
    const std::string_view name = file->d_name;
    if (name != "." && name != "..") each(name);
  }
  return true;
}

bool is_there(const std::string& path) {
  struct stat status {};
  return lstat(path.c_str(), &status) == 0 || errno != ENOENT;
}

}  // namespace

PartSource every_part(std::size_t first, std::size_t step) {
  return [next = first, step]() mutable { return std::exchange(next, next + step); };
}

std::uint64_t surface_hash(const PatchCache& cache) {
  std::string told = fmt::format(
      "mesh {} {} {} {} {} {} {} {}", cache.mesh_hash, cache.mesh_face_count, cache.scale,
      cache.origin[0], cache.origin[1], cache.origin[2], cache.surface.index(), cache.unit);
  cache_format::for_each_section(cache, [&](const char* name, const auto& values) {
    told += fmt::format(" {} {}", name,
                        cache_format::checksum(values.data(), values.size() * sizeof(values[0])));
  });
  return cache_format::checksum(told.data(), told.size());
}

std::uint64_t work_hash(std::uint64_t surface, const std::string& told) {
  const std::string all = fmt::format("{} {} {} {}", kNumbersRevision, kPartFormat, surface, told);
  return cache_format::checksum(all.data(), all.size());
}

void OwnedDescriptor::set(int descriptor) noexcept {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = descriptor;
}

PartFolder::PartFolder(const std::string& folder, std::uint64_t hash, PartsAccess access)
    : hash_(hash), folder_(folder), key_(fmt::format("{:016x}-", hash)), access_(access) {
  open_folder();
  const bool is_read = for_each_name(folder, [&](std::string_view name) {
    if (name.starts_with(key_))
      kept_ += name.ends_with(kEnding);
    else
      foreign_ += name != kMadeForParts;
  });
  if (!is_read) fail("cannot list");
}

// Work that ended may remove the folder before it is locked here; then there is another one.
void PartFolder::open_folder() {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    if (open_once()) return;
    lock_.set(-1);
  }
  errno = ENOENT;
  fail("cannot keep");
}

// False where the folder is gone again.
bool PartFolder::open_once() {
  const bool is_new = mkdir(folder_.c_str(), S_IRWXU) == 0;
  if (!is_new && errno != EEXIST) fail("cannot create");
  struct stat status {};
  if (lstat(folder_.c_str(), &status) == 0 && S_ISLNK(status.st_mode))
    refuse("it is a symbolic link; name the folder that it leads to");
  lock_.set(open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (lock_ < 0 && errno == ENOENT) return false;
  if (lock_ < 0 || fstat(lock_, &status) != 0) fail("cannot open");
  if (!is_new && status.st_uid != geteuid()) refuse("it belongs to another user");
  if ((status.st_mode & (S_IWOTH | S_IWGRP)) != 0)
    refuse("others may write to it; chmod go-w is the cure");
  // Let go of by the system when this process ends, however it does.
  const auto is_taken = [&](int kind) {
    return flock(lock_, kind | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  };
  if (is_taken(access_ == PartsAccess::kAlone ? LOCK_EX : LOCK_SH)) {
    refuse(is_taken(LOCK_SH) ? "another command is at work here"
                             : "shards are at work here; go on when they are done");
  }
  if (fstat(lock_, &status) != 0 || status.st_nlink == 0) return false;
  if (is_new) mark_as_made();
  return true;
}

PartFolder::~PartFolder() {
  if (access_ != PartsAccess::kAlone || unlinkat(lock_, kMadeForParts, 0) != 0) return;
  if (rmdir(folder_.c_str()) != 0) mark_as_made();  // other things are there
}

void PartFolder::mark_as_made() const {
  OwnedDescriptor(openat(lock_, kMadeForParts, O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
}

std::optional<PartFile> PartFolder::load(std::size_t part) {
  if (!is_there(path_of(part))) return {};
  auto found = read(part);
  if (!found) discard(part);
  return found;
}

std::optional<PartFile> PartFolder::read(std::size_t part) const {
  OpenPart opened(path_of(part));
  PartFile file;
  try {
    const LargeArray<char> all = opened.read_all();
    file.bytes.assign(all.begin(), all.end());
  } catch (const std::runtime_error&) {  // a pipe, a folder, one that cannot be read
    return {};
  }
  PartHeader header{};
  if (file.bytes.size() < sizeof header) return {};
  std::memcpy(&header, file.bytes.data(), sizeof header);
  if (std::string_view(header.magic, sizeof header.magic) != kMagic || header.part != part ||
      header.checksum != checksum_of(file.bytes)) {
    return {};
  }
  return file;
}

// Network file systems look for new files when the folder is opened, and late otherwise.
bool PartFolder::is_whole(std::size_t part) const {
  const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) close(folder);
  return has_header(path_of(part));
}

std::size_t PartFolder::whole() const {
  std::size_t count = 0;
  for_each_name(folder_, [&](std::string_view name) {
    count += name.starts_with(key_) && name.ends_with(kEnding) &&
             has_header(fmt::format("{}/{}", folder_, name));
  });
  return count;
}

std::string PartFolder::head(std::size_t part, std::size_t bytes) const {
  OpenPart opened(path_of(part));
  std::string body(bytes, '\0');
  const bool is_there = read_header(opened) && opened.read(body.data(), bytes) == bytes;
  return is_there ? body : "";
}

// By remove(3), which takes empty folders as well.
void PartFolder::discard(std::size_t part) {
  const std::string path = path_of(part);
  damaged_.push_back(path);
  if (std::remove(path.c_str()) != 0 && errno != ENOENT) {  // another shard has done so
    throw std::system_error(errno, std::generic_category(),
                            fmt::format("'{}' is not a part and cannot be removed", path));
  }
  --kept_;
}

void PartFolder::save(std::size_t part, PartFile& file) {
  PartHeader header{};
  kMagic.copy(header.magic, sizeof header.magic);
  header.part = part;
  std::memcpy(file.bytes.data(), &header, sizeof header);
  header.checksum = checksum_of(file.bytes);
  std::memcpy(file.bytes.data(), &header, sizeof header);
  const std::string path = path_of(part);
  const bool is_new = !is_there(path);
  AtomicFile output(path, 0600);
  output.write(file.bytes);
  output.commit();
  kept_ += is_new;
}

bool PartFolder::remove() {
  if (access_ == PartsAccess::kShared) {
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    access_ = PartsAccess::kAlone;
  }
  for_each_name(folder_, [&](std::string_view name) {
    if (name.starts_with(key_)) unlinkat(lock_, name.data(), 0);
  });
  return true;
}

void PartFolder::leave_mark(std::uint64_t mark) const { AtomicFile(path_of_mark(mark)).commit(); }

bool PartFolder::has_mark(std::uint64_t mark) const {
  return access(path_of_mark(mark).c_str(), F_OK) == 0;
}

void PartFolder::remove_mark(std::uint64_t mark) const { unlink(path_of_mark(mark).c_str()); }

std::string PartFolder::path_of_mark(std::uint64_t mark) const {
  return fmt::format("{}/{}{:016x}.mark", folder_, key_, mark);
}

std::string PartFolder::path_of(std::size_t part) const {
  return fmt::format("{}/{}{:06}{}", folder_, key_, part, kEnding);
}

void PartFolder::fail(const char* action) const {
  const int error = errno;
  throw std::system_error(error, std::generic_category(), fmt::format("{} '{}'", action, folder_));
}

void PartFolder::refuse(const char* why) const {
  throw std::runtime_error(fmt::format("parts folder '{}': {}", folder_, why));
}

}  // namespace gliss
