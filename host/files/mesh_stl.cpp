// STL, binary or ascii: triangles that share nothing. Corners at one place become one vertex. The
// normals of facets are skipped, for those of a smooth surface are made; so are colours.
#include <array>
#include <bit>
#include <cctype>
#include <cstring>

#include "gliss/base/hash_index.h"
#include "gliss/files/mesh_readers.h"

namespace gliss::detail {
namespace {

constexpr std::size_t kHead = 80 + 4, kTriangle = 50;  // bytes

std::string in_small_letters(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::uint32_t little_endian(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

void add_corner(const Vec3& position, std::size_t line, Mesh& mesh, Report& report) {
  if (!position.allFinite()) {
    report.fail("non-finite", {.face = static_cast<std::uint32_t>(mesh.face_count()), .line = line},
                "({}, {}, {}) is not finite", position.x(), position.y(), position.z());
  }
  mesh.corner_vertex.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
  mesh.positions.push_back(position);
}

// A count of triangles, then for each a normal, three corners (float) and two bytes of anything.
void read_binary(std::string_view text, Mesh& mesh, Report& report) {
  if (text.size() < kHead) {
    report.fail("syntax", {}, "neither begins with 'solid' nor has the head of a binary STL");
  }
  const std::size_t count = little_endian(&text[80]);
  for (std::size_t i = 0; i < count; ++i) {
    report.poll();
    const std::size_t at = kHead + i * kTriangle;
    if (text.size() < at + kTriangle) {
      report.fail("truncated", {}, "the file ends in triangle {} of {}", i, count);
    }
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::array<float, 3> p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = std::bit_cast<float>(little_endian(&text[at + 12 * (corner + 1) + 4 * k]));
      add_corner({p[0], p[1], p[2]}, 0, mesh, report);
    }
    end_face(mesh, 0, report);
  }
  if (const std::size_t end = kHead + count * kTriangle; text.size() > end) {
    report.fail("extra-data", {}, "{} bytes after the last of {} triangles", text.size() - end,
                count);
  }
}

// solid, then facets of one loop each, endsolid; several of these.
void read_ascii(std::string_view text, Mesh& mesh, Report& report) {
  TextCursor cursor(text, {}, report);
  std::string open;  // the statement that has to end
  const auto expect = [&](std::string_view within, const std::string& keyword) {
    if (open == within) return;
    report.fail("syntax", {.line = cursor.line()}, "{} {}", detail::quoted(keyword),
                open.empty() ? "before 'solid'" : fmt::format("within '{}'", open));
  };
  while (cursor.next()) {
    const std::string keyword = in_small_letters(cursor.word());
    if (keyword == "vertex") {
      expect("outer", keyword);
      add_corner(cursor.numbers("coordinate"), cursor.line(), mesh, report);
      cursor.end();
    } else if (keyword == "solid" || keyword == "facet" || keyword == "outer") {
      expect(keyword == "solid" ? "" : keyword == "facet" ? "solid" : "facet", keyword);
      open = keyword;
    } else if (keyword == "endloop") {
      expect("outer", keyword);
      end_face(mesh, cursor.line(), report);
      open = "facet";
    } else if (keyword == "endfacet" || keyword == "endsolid") {
      expect(keyword.substr(3), keyword);
      open = keyword == "endfacet" ? "solid" : "";
    } else {
      report.fail("syntax", {.line = cursor.line()}, "{} is no word of an STL",
                  detail::quoted(keyword));
    }
  }
  if (!open.empty()) report.fail("truncated", {}, "the file ends within '{}'", open);
}

void join_corners(Mesh& mesh, Report& report) {
  const std::vector<Vec3> corners = std::move(mesh.positions);
  mesh.positions.clear();
  HashIndex known(corners.size());
  const auto is_same = [&](std::uint32_t a, std::uint32_t b) { return corners[a] == corners[b]; };
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    report.poll();
    const std::uint32_t first = known.find_or_insert(c, mix_bits(corners[c]), is_same);
    mesh.corner_vertex[c] =
        first == c ? static_cast<std::uint32_t>(mesh.positions.size()) : mesh.corner_vertex[first];
    if (first == c) mesh.positions.push_back(corners[c]);
  }
}

}  // namespace

bool is_binary_stl(std::string_view text) {
  return in_small_letters(text.substr(0, 5)) != "solid" ||
         text.substr(0, kHead).find('\0') != text.npos;
}

void read_stl(std::string_view text, Mesh& mesh, Report& report) {
  (is_binary_stl(text) ? read_binary : read_ascii)(text, mesh, report);
  join_corners(mesh, report);
}

}  // namespace gliss::detail
