// STL, binary or ascii: triangles that share nothing. Corners at one place become one vertex. The
// normals of facets are skipped, for those of a smooth surface are made; so are colours.
#include <algorithm>
#include <cctype>

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

// A number of type T at a place of the text.
template <class T>
T little_endian(std::string_view text, std::size_t at) {
  text.remove_prefix(at);
  return *take_number<T>(text, std::endian::little);
}

void add_corner(const Vec3& position, std::size_t line, Mesh& mesh, Report& report) {
  if (!position.allFinite()) {
    report.fail("non-finite", {.face = static_cast<std::uint32_t>(mesh.face_count()), .line = line},
                "({}, {}, {}) is not finite", position.x(), position.y(), position.z());
  }
  mesh.corner_vertex.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
  mesh.positions.push_back(position);
}

// The attributes behind a triangle: how many bytes follow, or often a colour and none.
std::size_t attribute_of(std::string_view text, std::size_t triangle_at) {
  return little_endian<std::uint16_t>(text, triangle_at + kTriangle - 2);
}

// True if the attributes of so many triangles announce just the bytes that the file has.
bool has_payload(std::string_view text, std::size_t count, Report& report) {
  std::size_t at = kHead;
  for (std::size_t i = 0; i < count; ++i) {
    report.poll();
    if (at + kTriangle > text.size()) return false;
    at += kTriangle + attribute_of(text, at);
  }
  return at == text.size();
}

// How many triangles are in a file without payload. Some programs leave the count at 0, or are
// wrong by one, and some append what they like; the size tells them apart.
std::size_t count_triangles(std::string_view text, std::size_t said, Report& report) {
  const std::size_t bytes = text.size() - kHead, held = bytes / kTriangle;
  if (bytes == said * kTriangle) return said;
  if (bytes % kTriangle == 0 && said <= held + 1) {
    report.add(report.mended, "count-mismatch", {},
               "the header counts {} triangles, but the size of the file is that of {}; these are "
               "read",
               said, held);
    return held;
  }
  if (said == 0) {
    report.fail("truncated", {}, "the header counts 0 triangles, and the file ends in triangle {}",
                held);
  }
  if (said > held) report.fail("truncated", {}, "the file ends in triangle {} of {}", held, said);

  const std::size_t extra = bytes - said * kTriangle;
  for (std::size_t i = 0; i < said; ++i) {
    report.poll();
    const std::size_t attribute = attribute_of(text, kHead + i * kTriangle);
    if (attribute == 0) continue;
    if (attribute > extra) break;  // a colour
    report.fail("extra-data", {.face = static_cast<std::uint32_t>(i)},
                "{} bytes of attributes are announced, but those of all {} triangles do not fit "
                "the size of the file; export it without attributes",
                attribute, said);
  }
  report.add(report.mended, "extra-data", {}, "{} bytes after the last of {} triangles are skipped",
             extra, said);
  return said;
}

// A count of triangles, then for each a normal, three corners (float) and two bytes of attributes.
void read_binary(std::string_view text, Mesh& mesh, Report& report) {
  if (text.size() < kHead) {
    report.fail("syntax", {}, "neither begins with 'solid' nor has the head of a binary STL");
  }
  const std::size_t said = little_endian<std::uint32_t>(text, kHead - 4);
  const bool payload = text.size() != kHead + said * kTriangle && has_payload(text, said, report);
  const std::size_t count = payload ? said : count_triangles(text, said, report);
  for (std::size_t i = 0, at = kHead; i < count; ++i, at += kTriangle) {
    report.poll();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vec3 p;
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = static_cast<double>(little_endian<float>(text, at + 12 * (corner + 1) + 4 * k));
      add_corner(p, 0, mesh, report);
    }
    end_face(mesh, 0, report);
    if (payload) at += attribute_of(text, at);
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
    std::string keyword = in_small_letters(cursor.word());
    if (keyword == "end" || keyword == "outerloop")  // written apart, or together
      keyword = keyword == "end" ? "end" + in_small_letters(cursor.word()) : "outer";
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
      report.fail("syntax", {.line = cursor.line()}, "{} is not a word of an STL",
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
  text = text.substr(0, kHead);
  const bool has_nul = text.find('\0') != text.npos;
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return has_nul || in_small_letters(text.substr(0, 5)) != "solid";
}

void read_stl(std::string_view text, Mesh& mesh, Report& report) {
  (is_binary_stl(text) ? read_binary : read_ascii)(text, mesh, report);
  join_corners(mesh, report);
}

}  // namespace gliss::detail
