#include "host/sweep_parts.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>
#include <type_traits>

#include "host/atomic_file.h"
#include "host/cache_format.h"

namespace gliss {
namespace {

constexpr std::uint32_t kPartFormat = 2;
constexpr std::string_view kMagic = "GLSPART\n", kEnding = ".part";
static_assert(std::is_trivially_copyable_v<SweepStatistics>);

// A file: this, the statistics, the blocks.
struct PartHeader {
  char magic[8];
  std::uint64_t checksum;  // of all that follows
  std::uint64_t part;
};
constexpr std::size_t kChecked = offsetof(PartHeader, part);

std::uint64_t hash_of_sweep(const PatchCache& cache, const SweepOptions& o, bool samples) {
  std::string told =
      fmt::format("{} {} {} {} {} {} {} {} {} {} {}", GLISS_VERSION, kPartFormat,
                  sizeof(SweepStatistics), samples, o.part_contacts, o.rings, o.stiffness,
                  static_cast<int>(o.solver), o.max_iterations, o.tolerance, cache.unit);
  for (const double depth : o.depths) told += fmt::format(" depth {}", depth);
  for (const Method method : o.methods) told += fmt::format(" method {}", static_cast<int>(method));
  told +=
      fmt::format(" mesh {} {} {} {} {} {} {}", cache.mesh_hash, cache.mesh_face_count, cache.scale,
                  cache.origin[0], cache.origin[1], cache.origin[2], cache.surface.index());
  cache_format::for_each_section(cache, [&](const char* name, const auto& values) {
    told += fmt::format(" {} {}", name,
                        cache_format::checksum(values.data(), values.size() * sizeof(values[0])));
  });
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
  if (!take(bytes, &header, sizeof header) || header.depth_index >= depths ||
      header.method_index >= methods || header.rows > bytes.size()) {
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

std::optional<std::string> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(file.tellg()), '\0');
  file.seekg(0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return std::nullopt;
  return bytes;
}

std::uint64_t checksum_of(std::string_view file) {
  return cache_format::checksum(file.data() + kChecked, file.size() - kChecked);
}

}  // namespace

SweepParts::SweepParts(const std::string& folder, const PatchCache& cache,
                       const SweepOptions& options, bool samples)
    : folder_(folder),
      key_(fmt::format("{:016x}-", hash_of_sweep(cache, options, samples))),
      samples_(samples),
      depths_(options.depths.size()),
      methods_(options.methods.size()) {
  if (mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST) fail("cannot create");
  lock_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) fail("cannot open");
  // Let go of by the system when this process ends, however it does.
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    close(lock_);
    throw std::runtime_error(fmt::format("'{}': another sweep is at work here", folder));
  }
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string name = file.path().filename();
    if (!name.starts_with(key_))
      ++foreign_;
    else if (name.ends_with(kEnding))
      ++kept_;
  }
}

SweepParts::~SweepParts() {
  rmdir(folder_.c_str());  // refused while anything is there
  close(lock_);
}

// A new part: room for what comes before its blocks.
void SweepParts::begin() {
  file_.assign(sizeof(PartHeader) + depths_ * methods_ * sizeof(SweepStatistics), '\0');
}

bool SweepParts::load(std::size_t part, std::vector<SweepStatistics>& statistics,
                      const SweepSink& sink) {
  const std::string path = path_of(part);
  begin();
  const auto file = read_file(path);
  if (!file) return false;
  std::string_view rest = *file;
  PartHeader header{};
  statistics.resize(depths_ * methods_);
  if (!take(rest, &header, sizeof header) ||
      std::string_view(header.magic, sizeof header.magic) != kMagic || header.part != part ||
      header.checksum != checksum_of(*file) ||
      !take(rest, statistics.data(), statistics.size() * sizeof(SweepStatistics))) {
    damaged_.push_back(path);
    return false;
  }
  while (!rest.empty()) {
    SweepBlock block;
    if (!take(rest, block, depths_, methods_)) {
      throw std::logic_error(fmt::format("'{}' is whole and cannot be read", path));
    }
    sink(block);
  }
  return true;
}

void SweepParts::add(const SweepBlock& block) {
  if (!samples_) return;
  const BlockHeader header{block.depth_index, block.method_index, block.face.size()};
  put(file_, &header, sizeof header);
  for_each_column(block, [&](const auto& column) {
    put(file_, column.data(), column.size() * sizeof(column[0]));
  });
}

void SweepParts::save(std::size_t part, const std::vector<SweepStatistics>& statistics) {
  PartHeader header{};
  kMagic.copy(header.magic, sizeof header.magic);
  header.part = part;
  std::memcpy(file_.data(), &header, sizeof header);
  std::memcpy(file_.data() + sizeof header, statistics.data(),
              statistics.size() * sizeof(SweepStatistics));
  header.checksum = checksum_of(file_);
  std::memcpy(file_.data(), &header, sizeof header);
  AtomicFile file(path_of(part));
  file.write(file_);
  file.commit();
  ++kept_;
}

void SweepParts::remove() {
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    if (file.path().filename().string().starts_with(key_)) unlink(file.path().c_str());
  }
}

std::string SweepParts::path_of(std::size_t part) const {
  return fmt::format("{}/{}{:06}{}", folder_, key_, part, kEnding);
}

void SweepParts::fail(const char* action) const {
  throw std::system_error(errno, std::generic_category(), fmt::format("{} '{}'", action, folder_));
}

}  // namespace gliss
