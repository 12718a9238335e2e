#include "gliss/study/sweep_parts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <type_traits>
#include <utility>

#include "gliss/files/atomic_file.h"
#include "gliss/files/cache_format.h"
#include "gliss/files/open_file.h"
#include "gliss/surface/revision.h"

namespace gliss {
namespace {

constexpr std::uint32_t kPartFormat = 5;
constexpr std::string_view kMagic = "GLSPART\n", kEnding = ".part";
static_assert(std::is_trivially_copyable_v<SweepStatistics>);

// A file: this, the statistics, the blocks, the contacts of chunks that are begun.
struct PartHeader {
  char magic[8];
  std::uint64_t checksum;  // of all that follows
  std::uint64_t part, chunks, begun;
};
constexpr std::size_t kChecked = offsetof(PartHeader, part);

std::string told_of(const PatchCache& cache) {
  std::string told =
      fmt::format(" mesh {} {} {} {} {} {} {}", cache.mesh_hash, cache.mesh_face_count, cache.scale,
                  cache.origin[0], cache.origin[1], cache.origin[2], cache.surface.index());
  cache_format::for_each_section(cache, [&](const char* name, const auto& values) {
    told += fmt::format(" {} {}", name,
                        cache_format::checksum(values.data(), values.size() * sizeof(values[0])));
  });
  return told;
}

std::uint64_t hash_of_sweep(const std::string& surface, const PatchCache& cache,
                            const SweepOptions& o, bool samples) {
  std::string told =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {}", kNumbersRevision, kPartFormat,
                  sizeof(SweepStatistics), samples, o.part_contacts, o.rings, o.stiffness,
                  static_cast<int>(o.solver), o.max_iterations, o.tolerance, cache.unit);
  for (const double depth : o.depths) told += fmt::format(" depth {}", depth);
  for (const Method method : o.methods) told += fmt::format(" method {}", static_cast<int>(method));
  told += surface;
  return cache_format::checksum(told.data(), told.size());
}

// Calls f(column) for each column of a block.
template <class Block, class F>
void for_each_column(Block& block, const F& f) {
  f(block.face);
  f(block.xi);
  f(block.eta);
  f(block.hip);
  f(block.scp);
  f(block.force);
  f(block.residual_angle);
  f(block.iterations);
  f(block.crossings);
  f(block.flags);
}

void put(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

// Takes what was put; false at the end.
bool take(std::string_view& bytes, void* to, std::size_t size) {
  if (bytes.size() < size) return false;
  if (size > 0) std::memcpy(to, bytes.data(), size);
  bytes.remove_prefix(size);
  return true;
}

struct BlockHeader {
  std::uint64_t depth_index, method_index, rows;
};

bool take(std::string_view& bytes, SweepBlock& block, std::size_t depths, std::size_t methods) {
  BlockHeader header{};
  std::size_t row_bytes = 0;
  for_each_column(block, [&](const auto& column) { row_bytes += sizeof(column[0]); });
  if (!take(bytes, &header, sizeof header) || header.depth_index >= depths ||
      header.method_index >= methods || header.rows > bytes.size() / row_bytes) {
    return false;
  }
  block.depth_index = header.depth_index;
  block.method_index = header.method_index;
  bool whole = true;
  for_each_column(block, [&](auto& column) {
    column.resize(header.rows);
    whole = whole && take(bytes, column.data(), header.rows * sizeof(column[0]));
  });
  return whole;
}

// True if the points of a block, which is taken from a file, can be a sweep's. What was felt there
// need not be finite: where a surface is at fault it is not.
bool is_in_range(const SweepBlock& block, const PatchCache& cache) {
  const auto finite = [](const std::vector<double>& column) {
    return std::all_of(column.begin(), column.end(), [](double x) { return std::isfinite(x); });
  };
  const bool faces = std::all_of(block.face.begin(), block.face.end(), [&](std::uint32_t face) {
    return face < cache.mesh_face_count && cache.face_patch[face] != kNone;
  });
  return faces && finite(block.xi) && finite(block.eta);
}

// A part under way has chunks that are begun. The checksum is left to who reads it.
bool has_whole_head(const std::string& path) {
  OpenFile opened(path, O_RDONLY | O_NOFOLLOW);
  PartHeader header{};
  return opened.descriptor() >= 0 && opened.read(&header, sizeof header) == sizeof header &&
         header.begun == 0;
}

std::uint64_t checksum_of(std::string_view file) {
  return cache_format::checksum(file.data() + kChecked, file.size() - kChecked);
}

}  // namespace

SweepParts::SweepParts(const std::string& folder, const PatchCache& cache,
                       const SweepOptions& options, bool samples, double patience,
                       PartsAccess access)
    : cache_(cache),
      folder_(folder),
      access_(access),
      samples_(samples),
      depths_(options.depths),
      methods_(options.methods),
      patience_(patience) {
  const std::string surface = told_of(cache);
  surface_hash_ = cache_format::checksum(surface.data(), surface.size());
  hash_ = hash_of_sweep(surface, cache, options, samples);
  key_ = fmt::format("{:016x}-", hash_);
  open_folder();
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename();
    if (!name.starts_with(key_))
      ++foreign_;
    else if (name.ends_with(kEnding))
      ++kept_;
  }
}

// A sweep that ended may remove the folder before it is locked here; then there is another one.
void SweepParts::open_folder() {
  constexpr int kTries = 100;
  for (int i = 0; i < kTries; ++i) {
    if (open_once()) return;
    if (lock_ >= 0) close(std::exchange(lock_, -1));
  }
  errno = ENOENT;
  fail("cannot keep");
}

// Folders that a sweep made are told by their sticky bit, which means nothing in a folder of one
// user: a sweep that goes on may remove them, and nobody else's. False where it is gone again.
bool SweepParts::open_once() {
  const bool is_new = mkdir(folder_.c_str(), S_ISVTX | S_IRWXU) == 0;
  if (!is_new && errno != EEXIST) fail("cannot create");
  struct stat status {};
  if (lstat(folder_.c_str(), &status) == 0 && S_ISLNK(status.st_mode))
    refuse("it is a symbolic link; name the folder that it leads to");
  lock_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (lock_ < 0 && errno == ENOENT) return false;
  if (lock_ < 0 || fstat(lock_, &status) != 0) fail("cannot open");
  if (!is_new && status.st_uid != geteuid()) refuse("it belongs to another user");
  if ((status.st_mode & S_IWOTH) != 0) refuse("all may write to it; chmod o-w is the cure");
  // Let go of by the system when this process ends, however it does.
  const auto is_taken = [&](int kind) {
    return flock(lock_, kind | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  };
  if (is_taken(access_ == PartsAccess::kAlone ? LOCK_EX : LOCK_SH)) {
    refuse(is_taken(LOCK_SH) ? "another sweep is at work here"
                             : "shards of a sweep are at work here; go on when they are done");
  }
  made_ = is_new || (status.st_mode & S_ISVTX) != 0;
  return fstat(lock_, &status) == 0 && status.st_nlink > 0;
}

SweepParts::~SweepParts() {
  if (made_ && access_ == PartsAccess::kAlone)
    rmdir(folder_.c_str());  // refused while anything is there
  close(lock_);
}

std::optional<SweepPart> SweepParts::load(std::size_t part) {
  // Room for what comes before the blocks, should it have to be done.
  file_.assign(sizeof(PartHeader) + depths_.size() * methods_.size() * sizeof(SweepStatistics),
               '\0');
  saved_ = clock_.seconds();
  struct stat status {};
  is_there_ = lstat(path_of(part).c_str(), &status) == 0 || errno != ENOENT;
  if (!is_there_) return {};
  auto found = read(part);
  if (!found) discard(part);
  return found;
}

std::optional<SweepPart> SweepParts::read(std::size_t part) const {
  OpenFile opened(path_of(part), O_RDONLY | O_NOFOLLOW);
  std::string file;
  try {
    file = opened.read_all();
  } catch (const std::runtime_error&) {  // a pipe, a folder, one that cannot be read
    return {};
  }
  std::string_view rest = file;
  PartHeader header{};
  SweepPart found;
  found.statistics.resize(depths_.size() * methods_.size());
  if (!take(rest, &header, sizeof header) ||
      std::string_view(header.magic, sizeof header.magic) != kMagic || header.part != part ||
      header.checksum != checksum_of(file) ||
      !take(rest, found.statistics.data(), found.statistics.size() * sizeof(SweepStatistics))) {
    return {};
  }
  found.chunks = header.chunks;
  found.begun = header.begun;
  const std::size_t kinds = found.statistics.size(), blocks = samples_ ? found.chunks * kinds : 0;
  while (found.blocks.size() < blocks) {
    if (!take(rest, found.blocks.emplace_back(), depths_.size(), methods_.size())) return {};
  }
  if (rest.size() % (SweepPart::kContactReals * methods_.size() * sizeof(double)) != 0 ||
      rest.empty() != (found.begun == 0)) {
    return {};
  }
  found.contacts.resize(rest.size() / sizeof(double));
  if (!take(rest, found.contacts.data(), rest.size()) || !is_in_range(found)) return {};
  return found;
}

bool SweepParts::is_in_range(const std::vector<SweepStatistics>& statistics) const {
  for (std::size_t kind = 0; kind < statistics.size(); ++kind) {
    const SweepStatistics& s = statistics[kind];
    const Histogram* const all[] = {&s.step, &s.edge_step, &s.angle, &s.error, &s.residual};
    if (s.depth != depths_[kind / methods_.size()] ||
        s.method != methods_[kind % methods_.size()] || s.touching > s.samples ||
        s.unconverged > s.samples || s.error.count() != s.samples ||
        s.residual.count() != s.samples || s.jumps > s.step.count() + s.edge_step.count() ||
        s.lost > s.jumps || s.leaps > s.jumps ||
        !std::all_of(std::begin(all), std::end(all), [](auto* h) { return h->is_consistent(); })) {
      return false;
    }
  }
  return true;
}

bool SweepParts::is_in_range(const SweepPart& part) const {
  if (!is_in_range(part.statistics)) return false;
  for (std::size_t i = 0; i < part.contacts.size(); ++i) {
    const double x = part.contacts[i];
    const bool is_count = i % SweepPart::kContactReals >= SweepPart::kContactCounts;
    if (is_count && !(x >= 0 && x < 0x1p31 && x == std::floor(x))) return false;
  }
  return std::all_of(part.blocks.begin(), part.blocks.end(),
                     [&](const SweepBlock& block) { return gliss::is_in_range(block, cache_); });
}

std::vector<SweepStatistics> SweepParts::statistics(std::size_t part) const {
  OpenFile opened(path_of(part), O_RDONLY | O_NOFOLLOW);
  PartHeader header{};
  std::vector<SweepStatistics> found(depths_.size() * methods_.size());
  const std::size_t bytes = found.size() * sizeof found[0];
  if (opened.descriptor() < 0 || opened.read(&header, sizeof header) != sizeof header ||
      header.part != part || header.begun != 0 || opened.read(found.data(), bytes) != bytes ||
      !is_in_range(found)) {
    return {};
  }
  return found;
}

// Network file systems look for new files when the folder is opened, and late otherwise.
bool SweepParts::is_whole(std::size_t part) const {
  const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) close(folder);
  return has_whole_head(path_of(part));
}

std::size_t SweepParts::whole() const {
  std::size_t count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    const std::string name = file.path().filename();
    count += name.starts_with(key_) && name.ends_with(kEnding) && has_whole_head(file.path());
  }
  return count;
}

// By remove(3), which takes empty folders as well.
void SweepParts::discard(std::size_t part) {
  const std::string path = path_of(part);
  damaged_.push_back(path);
  if (std::remove(path.c_str()) != 0 && errno != ENOENT) {  // another shard has done so
    throw std::system_error(errno, std::generic_category(),
                            fmt::format("'{}' is no part of a sweep and cannot be removed", path));
  }
  --kept_;
  is_there_ = false;
}

void SweepParts::add(const SweepBlock& block) {
  if (!samples_) return;
  const BlockHeader header{block.depth_index, block.method_index, block.face.size()};
  put(file_, &header, sizeof header);
  for_each_column(block, [&](const auto& column) {
    put(file_, column.data(), column.size() * sizeof(column[0]));
  });
}

void SweepParts::save(std::size_t part, const std::vector<SweepStatistics>& statistics,
                      std::size_t chunks, std::size_t begun, std::span<const double> contacts) {
  PartHeader header{};
  kMagic.copy(header.magic, sizeof header.magic);
  header.part = part;
  header.chunks = chunks;
  header.begun = begun;
  const std::size_t whole = file_.size();
  put(file_, contacts.data(), contacts.size_bytes());
  std::memcpy(file_.data(), &header, sizeof header);
  std::memcpy(file_.data() + sizeof header, statistics.data(),
              statistics.size() * sizeof(SweepStatistics));
  header.checksum = checksum_of(file_);
  std::memcpy(file_.data(), &header, sizeof header);
  AtomicFile file(path_of(part));
  file.write(file_);
  file.commit();
  file_.resize(whole);
  kept_ += !std::exchange(is_there_, true);
  saved_ = clock_.seconds();
}

bool SweepParts::remove() {
  if (access_ == PartsAccess::kShared) {
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
    access_ = PartsAccess::kAlone;
  }
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    if (file.path().filename().string().starts_with(key_)) unlink(file.path().c_str());
  }
  return true;
}

void SweepParts::leave_mark(std::uint64_t mark) const { AtomicFile(path_of_mark(mark)).commit(); }

bool SweepParts::has_mark(std::uint64_t mark) const {
  return access(path_of_mark(mark).c_str(), F_OK) == 0;
}

void SweepParts::remove_mark(std::uint64_t mark) const { unlink(path_of_mark(mark).c_str()); }

std::string SweepParts::path_of_mark(std::uint64_t mark) const {
  return fmt::format("{}/{}{:016x}.mark", folder_, key_, mark);
}

std::string SweepParts::path_of(std::size_t part) const {
  return fmt::format("{}/{}{:06}{}", folder_, key_, part, kEnding);
}

void SweepParts::fail(const char* action) const {
  const int error = errno;
  if (lock_ >= 0) close(lock_);
  throw std::system_error(error, std::generic_category(), fmt::format("{} '{}'", action, folder_));
}

void SweepParts::refuse(const char* why) const {
  if (lock_ >= 0) close(lock_);
  throw std::runtime_error(fmt::format("parts folder '{}': {}", folder_, why));
}

}  // namespace gliss
