// Layout of a cache file: a header, a table of its sections, the sections. Nothing lies between
// them or after them, and every byte is checked. Private to cache_file.cpp and the test that forges
// files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/large_array.h"

namespace gliss::cache_format {

inline constexpr std::string_view kMagic = "\x89GLS\r\n\x1a\n";  // no transfer as text keeps it
inline constexpr std::size_t kNameBytes = 4;  // of it; a damaged cache is still known by these
inline constexpr std::uint32_t kByteOrder = 0x01020304, kSwappedByteOrder = 0x04030201;
// The format of Header and Section: which sections there are, and what they mean.
inline constexpr std::uint32_t kFormat = 6;
inline constexpr std::uint32_t kMaxHeaderBytes = 1 << 16;

// Up to header_bytes it stays as it is in every later format, so that their files are told from
// damaged ones.
struct Header {
  char magic[8];
  std::uint64_t checksum;  // of the header and table after this number
  std::uint64_t file_bytes;
  std::uint32_t byte_order;
  std::uint32_t format;
  std::uint32_t header_bytes;  // header and table

  std::uint32_t section_count;
  char gliss_version[12];                 // of the program that built it, for people
  std::uint32_t numbers_revision;         // kNumbersRevision
  std::uint32_t side_reals, patch_reals;  // numbers of a side and of a patch
  std::uint32_t precision, construction, level, table_cells, mesh_face_count, creases;
  std::uint64_t mesh_hash;
  double unit, origin[3], scale;
  double departure[2], tightest[2];  // distance and room
  std::uint32_t departure_face, tightest_face;
};
inline constexpr std::size_t kChecksumBegin = offsetof(Header, file_bytes);
inline constexpr std::size_t kFixedBytes = offsetof(Header, section_count);
static_assert(sizeof(Header) == 176, "no padding");

enum class Element : std::uint32_t { kUint8 = 1, kUint32, kFloat32, kFloat64 };

struct Section {
  char name[16];
  std::uint64_t count;     // of elements
  std::uint64_t offset;    // in the file
  std::uint64_t checksum;  // of its bytes
  Element element;
  std::uint32_t element_bytes;
};
static_assert(sizeof(Section) == 48, "no padding");

inline constexpr std::size_t kSections = 26;
inline constexpr std::size_t kHeaderBytes = sizeof(Header) + kSections * sizeof(Section);

template <class T>
const LargeArray<T>& array_of(const SharedArray<T>& shared) {
  return shared.read();
}
template <class T>
LargeArray<T>& array_of(SharedArray<T>& shared) {
  return shared.write();
}

// Calls f(name, vector) for each section, in the order of the file.
template <class Cache, class F>
void for_each_section(Cache& cache, const F& f) {
  std::visit(
      [&](auto& s) {
        f("domain", s.domain);
        f("domain_begin", s.domain_begin);
        f("side_begin", s.side_begin);
        f("side_patch", s.side_patch);
        f("side_twin", s.side_twin);
        f("control", s.control);
        f("control_begin", s.control_begin);
        f("form", s.form);
        f("corner", s.corner);
        f("patch", s.patch);
        f("triangle", s.triangle);
        f("node", s.node);
        f("child", s.child);
        f("tile", s.tile);
        f("tile_begin", s.tile_begin);
        f("part", s.part);
        f("part_table", s.part_table);
        f("partner", s.partner);
        f("part_box", s.part_box);
      },
      cache.surface);
  f("patch_face", cache.patch_face);
  f("face_patch", cache.face_patch);
  f("kind", cache.kind);
  f("folded", cache.folded);
  f("rho_min", cache.rho_min);
  f("corner_of_face", cache.corner_of_face);
  f("face_valence", array_of(cache.face_valence));
}

template <class T>
constexpr Element element_of() {
  if constexpr (std::is_same_v<T, float>) return Element::kFloat32;
  if constexpr (std::is_same_v<T, double>) return Element::kFloat64;
  if constexpr (std::is_same_v<T, std::uint32_t>) return Element::kUint32;
  static_assert(std::is_floating_point_v<T> || std::is_same_v<T, std::uint32_t> || sizeof(T) == 1);
  return Element::kUint8;
}

// A section but for its checksum.
template <class T>
Section section_of(const char* name, std::uint64_t count, std::uint64_t offset) {
  Section section{};
  std::strncpy(section.name, name, sizeof(section.name) - 1);
  section.count = count;
  section.offset = offset;
  section.element = element_of<T>();
  section.element_bytes = sizeof(T);
  return section;
}

GLISS_EXPORT std::uint64_t checksum(const void* data, std::size_t bytes);  // XXH3, 64 bits

}  // namespace gliss::cache_format
