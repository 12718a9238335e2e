#include "gliss/files/cache_file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "gliss/files/atomic_file.h"
#include "gliss/files/cache_check.h"
#include "gliss/files/cache_format.h"
#include "gliss/files/open_file.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/names.h"
#include "gliss/surface/patch_cache.h"
#include "gliss/surface/revision.h"

namespace gliss {
namespace cache_format {

std::uint64_t checksum(const void* data, std::size_t bytes) { return XXH3_64bits(data, bytes); }

}  // namespace cache_format

namespace {

using namespace cache_format;

// Stays in a core's own cache from read to checksum to copy.
constexpr std::size_t kBlockBytes = 1 << 18;

static_assert(sizeof(Surface<float>) == 19 * sizeof(LargeArray<float>),
              "an array was added: list it in for_each_section and check_cache, and raise kFormat");

void put_departure(const Departure& from, double* to, std::uint32_t& face) {
  to[0] = from.distance;
  to[1] = from.room;
  face = from.face;
}

// The header of a cache of this program, with sizes and checksum still to come.
Header header_of(const PatchCache& cache) {
  Header h{};
  std::copy(kMagic.begin(), kMagic.end(), h.magic);
  h.byte_order = kByteOrder;
  h.format = kFormat;
  std::strncpy(h.gliss_version, GLISS_VERSION, sizeof(h.gliss_version) - 1);
  h.numbers_revision = kNumbersRevision;
  h.side_reals = kSideReals;
  h.patch_reals = kPatchReals;
  h.precision = static_cast<std::uint32_t>(cache.precision());
  h.construction = static_cast<std::uint32_t>(cache.level.construction);
  h.level = static_cast<std::uint32_t>(cache.level.kind);
  h.table_cells = cache.level.cells;
  h.mesh_hash = cache.mesh_hash;
  h.mesh_face_count = cache.mesh_face_count;
  h.creases = cache.crease_count;
  h.unit = cache.unit;
  std::copy_n(cache.origin.data(), 3, h.origin);
  h.scale = cache.scale;
  put_departure(cache.departure, h.departure, h.departure_face);
  put_departure(cache.tightest, h.tightest, h.tightest_face);
  return h;
}

class Reader {
 public:
  Reader(const std::string& path, const Poll& poll)
      : path_(path), poll_(poll), file_(path), file_bytes_(file_.size()) {
    file_.check();
  }

  PatchCache read() {
    const std::array<Section, kSections> table = read_header();
    PatchCache cache;
    cache.level = {static_cast<Level::Kind>(header_.level), header_.table_cells,
                   static_cast<Construction>(header_.construction)};
    cache.unit = header_.unit;
    cache.origin = Vec3(header_.origin[0], header_.origin[1], header_.origin[2]);
    cache.scale = header_.scale;
    cache.mesh_face_count = header_.mesh_face_count;
    cache.crease_count = header_.creases;
    cache.mesh_hash = header_.mesh_hash;
    cache.departure = {header_.departure[0], header_.departure[1], header_.departure_face};
    cache.tightest = {header_.tightest[0], header_.tightest[1], header_.tightest_face};
    if (static_cast<Precision>(header_.precision) == Precision::kDouble) cache.surface.emplace<1>();
    std::size_t next = 0;
    for_each_section(cache, [&](const char* name, auto& values) {
      read_section(table.at(next++), name, values);
    });
    if (position_ != file_bytes_) fail("header", "more than its sections");
    check_cache(cache, path_);
    find_open_parts(cache);
    find_folds(cache);
    return cache;
  }

 private:
  [[noreturn]] void fail(const char* section, const char* what) const {
    throw CacheError(fmt::format("{}: section '{}': {}", path_, section, what), false);
  }
  [[noreturn]] void fail_as_stale(const std::string& what) const {
    throw CacheError(fmt::format("{}: {}; build it again", path_, what), true);
  }

  void read_bytes(void* to, std::size_t bytes, const char* section) {
    poll_();
    if (file_.read(to, bytes) < bytes) fail(section, "cut short");
    position_ += bytes;
  }

  // Sound and of this program when it returns.
  std::array<Section, kSections> read_header() {
    std::vector<unsigned char> bytes(kFixedBytes);
    read_bytes(bytes.data(), std::min<std::uint64_t>(file_bytes_, kFixedBytes), "header");
    if (std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) != 0) {
      throw CacheError(
          fmt::format("{}: not a gliss cache, or changed by a transfer as text", path_), false);
    }
    if (file_bytes_ < kFixedBytes) fail("header", "cut short");
    std::memcpy(&header_, bytes.data(), kFixedBytes);
    if (header_.byte_order == kSwappedByteOrder) {
      fail_as_stale("written by a machine of the other byte order");
    }
    if (header_.header_bytes < kFixedBytes || header_.header_bytes > kMaxHeaderBytes) {
      fail("header", "its size is out of range");
    }
    bytes.resize(header_.header_bytes);
    read_bytes(bytes.data() + kFixedBytes, bytes.size() - kFixedBytes, "header");
    if (header_.checksum != checksum(&bytes[kChecksumBegin], bytes.size() - kChecksumBegin)) {
      fail("header", "checksum differs");
    }
    if (header_.file_bytes != file_bytes_) {
      throw CacheError(
          fmt::format("{}: {} bytes where {} belong", path_, file_bytes_, header_.file_bytes),
          false);
    }
    if (header_.format != kFormat) {
      fail_as_stale(fmt::format("of format {}, this program reads {}", header_.format, kFormat));
    }
    if (bytes.size() < sizeof(Header)) fail("header", "its size is wrong");
    std::memcpy(&header_, bytes.data(), sizeof(Header));
    check_origin();
    if (header_.section_count != kSections || bytes.size() != kHeaderBytes) {
      fail("header", "its size is wrong");
    }
    std::array<Section, kSections> table;
    std::memcpy(table.data(), bytes.data() + sizeof(Header), sizeof(table));
    return table;
  }

  void check_origin() const {
    const Header own = header_of({});
    if (header_.numbers_revision != own.numbers_revision) {
      const std::size_t length = strnlen(header_.gliss_version, sizeof(header_.gliss_version));
      fail_as_stale(fmt::format("built by gliss {} with numbers of revision {}, this is {} of {}",
                                std::string_view(header_.gliss_version, length),
                                header_.numbers_revision, own.gliss_version, own.numbers_revision));
    }
    if (header_.side_reals != own.side_reals || header_.patch_reals != own.patch_reals) {
      fail_as_stale("its numbers are laid out as in another build of gliss");
    }
    if (header_.precision > static_cast<std::uint32_t>(Precision::kDouble)) {
      fail("header", "an unknown precision");
    }
    const bool table = header_.level == Level::kTable;
    if (header_.level > Level::kTable || header_.table_cells > kMostTableCells ||
        table != (header_.table_cells > 0) ||
        header_.construction > static_cast<std::uint32_t>(Construction::kFair)) {
      fail("header", "an unknown level");
    }
  }

  template <class T, class A>
  void read_section(const Section& section, const char* name, std::vector<T, A>& values) {
    Section expected = section_of<T>(name, section.count, position_);
    expected.checksum = section.checksum;
    if (std::memcmp(&section, &expected, sizeof(section)) != 0) {
      fail(name, "its entry in the table is wrong");
    }
    if (section.count > (file_bytes_ - position_) / sizeof(T)) fail(name, "ends beyond the file");
    values.reserve(section.count);
    std::vector<T> block(std::min<std::size_t>(section.count, kBlockBytes / sizeof(T)));
    XXH3_state_t hash;
    XXH3_64bits_reset(&hash);
    while (values.size() < section.count) {
      const std::size_t count = std::min(block.size(), section.count - values.size());
      read_bytes(block.data(), count * sizeof(T), name);
      XXH3_64bits_update(&hash, block.data(), count * sizeof(T));
      values.insert(values.end(), block.begin(),
                    block.begin() + static_cast<std::ptrdiff_t>(count));
    }
    if (XXH3_64bits_digest(&hash) != section.checksum) fail(name, "checksum differs");
  }

  const std::string& path_;
  const Poll& poll_;
  OpenFile file_;
  std::uint64_t file_bytes_, position_ = 0;
  Header header_{};
};

}  // namespace

void save_cache(const PatchCache& cache, const std::string& path, const Poll& poll) {
  constexpr std::size_t kPiece = std::size_t{1} << 24;  // bytes
  const auto ask = [&] { poll(); };
  require_patches(cache);
  if (cache.face_patch.empty()) {
    PatchCache listed = cache;
    for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face)
      listed.face_patch.push_back(cache.first_patch(face));
    return save_cache(listed, path, poll);
  }
  AtomicFile file(path);
  std::array<Section, kSections> table;
  std::size_t next = 0;
  std::uint64_t end = kHeaderBytes;
  for_each_section(cache, [&]<class T, class A>(const char* name, const std::vector<T, A>& values) {
    Section& section = table.at(next++) = section_of<T>(name, values.size(), end);
    section.checksum = checksum(values.data(), values.size() * sizeof(T));
    ask();
    end += values.size() * sizeof(T);
  });
  Header header = header_of(cache);
  header.section_count = kSections;
  header.header_bytes = kHeaderBytes;
  header.file_bytes = end;

  std::array<unsigned char, kHeaderBytes> head;
  std::memcpy(head.data(), &header, sizeof(header));
  std::memcpy(&head[sizeof(header)], table.data(), sizeof(table));
  const std::uint64_t sum = checksum(&head[kChecksumBegin], head.size() - kChecksumBegin);
  std::memcpy(&head[offsetof(Header, checksum)], &sum, sizeof(sum));
  file.write(head.data(), head.size());
  for_each_section(cache, [&]<class T, class A>(const char*, const std::vector<T, A>& values) {
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    const std::size_t count = values.size() * sizeof(T);
    for (std::size_t at = 0; at < count; at += kPiece) {
      file.write(bytes + at, std::min(kPiece, count - at));
      ask();
    }
  });
  file.commit();
}

PatchCache load_cache(const std::string& path, const Poll& poll) {
  return Reader(path, poll).read();
}

PatchCache load_cache_of(const std::string& path, const CacheWanted& wanted, const Poll& poll) {
  const auto& [precision, level, construction] = wanted;
  PatchCache cache = load_cache(path, poll);
  if (precision && *precision != cache.precision()) {
    throw CacheError(fmt::format("{}: a cache in {}; for --precision {} bake the mesh again", path,
                                 precision_name(cache.precision()), precision_name(*precision)),
                     true);
  }
  if (construction && *construction != cache.level.construction) {
    throw CacheError(
        fmt::format("{}: a cache of the {} construction; for --construction {} bake the mesh again",
                    path, construction_name(cache.level.construction),
                    construction_name(*construction)),
        true);
  }
  if (level && level_name(*level) != level_name(cache.level)) {
    throw CacheError(fmt::format("{}: a cache of level {}; for --level {} bake the mesh again",
                                 path, level_name(cache.level), level_name(*level)),
                     true);
  }
  return cache;
}

bool is_cache_file(const std::string& path) {
  const OpenFile file(path);
  char begin[kNameBytes] = {};
  const ssize_t count = ::read(file.descriptor(), begin, sizeof(begin));
  return count == static_cast<ssize_t>(kNameBytes) &&
         std::string_view(begin, kNameBytes) == kMagic.substr(0, kNameBytes);
}

bool is_meant_as_cache(const std::string& path) {
  return path.ends_with(".gliss") || is_cache_file(path);
}

}  // namespace gliss
