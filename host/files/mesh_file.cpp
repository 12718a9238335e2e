// Mesh files: the reader by the ending of the name, the checks, and the writer.
#include "gliss/files/mesh_file.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

#include "gliss/base/poll.h"
#include "gliss/files/atomic_file.h"
#include "gliss/files/line_reader.h"
#include "gliss/files/mesh_readers.h"
#include "gliss/files/open_file.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

struct Format {
  void (*read)(std::string_view, Mesh&, Report&);
  bool (*is_binary)(std::string_view);
};

constexpr bool is_text(std::string_view) { return false; }

constexpr std::array kEndings{std::string_view(".obj"), std::string_view(".off"),
                              std::string_view(".ply"), std::string_view(".stl")};
constexpr std::array<Format, kEndings.size()> kFormats{{{detail::read_obj, is_text},
                                                        {detail::read_off, detail::is_binary_off},
                                                        {detail::read_ply, detail::is_binary_ply},
                                                        {detail::read_stl, detail::is_binary_stl}}};

// Null for another ending.
const Format* find_format(const std::string& path) {
  const std::size_t dot = path.find_last_of("./");
  std::string ending = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto known = std::find(kEndings.begin(), kEndings.end(), ending);
  return known == kEndings.end() ? nullptr : &kFormats[known - kEndings.begin()];
}

const Format& format_of(const std::string& path, Report& report) {
  if (const Format* const format = find_format(path)) return *format;
  report.fail("unsupported", {}, "the file must end in one of {}, which Blender and MeshLab export",
              fmt::join(kEndings, ", "));
}

// Asked block by block, so that a file without lines, such as a large hole, is not read to its end.
LargeArray<char> read_file(OpenFile& file, const Format& format, const Poll& poll, Report& report) {
  std::size_t line = 0, searched = 0;  // where the last line begins; where the next block does
  const auto check_lines = [&](std::string_view text) {
    poll();
    const std::size_t end = text.substr(searched).find_last_of("\r\n");
    if (end != text.npos) line = searched + end + 1;
    searched = text.size();
    if (searched - line <= kLongestLine || format.is_binary(text)) return;
    const auto lines = std::count(text.begin(), text.end(), '\n');
    report.fail("unsupported", {.line = static_cast<std::size_t>(lines) + 1},
                "a line of over {} bytes, not a text file?", kLongestLine);
  };
  try {
    return file.read_all(check_lines);
  } catch (const std::system_error&) {
    report.fail("unreadable", {}, "cannot be read: {}", file.why());
  }
}

// What downloads leave in place of a mesh.
void refuse_stand_ins(std::string_view text, Report& report) {
  const auto begins = [&](std::string_view with) { return text.starts_with(with); };
  if (begins("\x1f\x8b")) report.fail("unsupported", {}, "is compressed by gzip; unpack it first");
  if (begins("PK\x03\x04")) report.fail("unsupported", {}, "is a zip archive; unpack it first");
  if (begins("version https://git-lfs"))
    report.fail("unsupported", {},
                "names a file of Git LFS, and is not it; 'git lfs pull' fetches it");
  if (begins("\xff\xfe") || begins("\xfe\xff"))
    report.fail("unsupported", {}, "is text in UTF-16; save it as UTF-8");
  if (begins("<!DOCTYPE") || begins("<!doctype") || begins("<html"))
    report.fail("unsupported", {}, "is a web page; download the file that it leads to");
}

void take(Mesh& mesh, const LoadOptions& options, Report& report) {
  validate(mesh, options, report);
  const Topology topology = build_topology(mesh);
  std::vector<std::uint32_t> sides;
  if (!options.creases.edges.empty()) sides = read_edges(options.creases.edges, mesh, topology);
  mark_creases(mesh, topology, options.creases, sides, report);
}

}  // namespace

Mesh load_mesh(const std::string& path, const LoadOptions& options,
               std::vector<Finding>* findings) {
  Mesh mesh;
  mesh.source = path;
  mesh.unit = options.unit;
  Report report(mesh, findings, options.poll, options.strict);
  OpenFile file(path);
  if (file.descriptor() < 0) report.fail("unreadable", {}, "cannot be read: {}", file.why());
  const Format& format = format_of(path, report);
  const LargeArray<char> bytes = read_file(file, format, options.poll, report);
  const std::string_view text(bytes.data(), bytes.size());
  refuse_stand_ins(text, report);
  format.read(text, mesh, report);
  take(mesh, options, report);
  return mesh;
}

void take_mesh(Mesh& mesh, const LoadOptions& options, std::vector<Finding>* findings) {
  Report report(mesh, findings, options.poll, options.strict);
  take(mesh, options, report);
}

std::span<const std::string_view> mesh_endings() { return kEndings; }

bool has_mesh_ending(const std::string& path) { return find_format(path) != nullptr; }

std::vector<std::uint32_t> read_edges(const std::string& path, const Mesh& mesh,
                                      const Topology& topology) {
  std::vector<std::uint32_t> sides;
  LineReader lines(path);
  const auto fail = [&](const std::string& why) {
    throw MeshError(fmt::format("{}:{}: {}", path, lines.line_number(), why));
  };
  for (std::string_view line; lines.next(line);) {
    line = line.substr(0, line.find('#'));
    std::vector<std::string_view> words;
    for (std::size_t i = 0; (i = line.find_first_not_of(" \t\r", i)) != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
      words.push_back(line.substr(i, end - i));
      i = end;
    }
    if (words.empty()) continue;
    VertexPair edge{};
    if (words.size() != 2) fail("an edge is two vertex numbers");
    for (std::size_t i = 0; i < 2; ++i) {
      const std::optional<std::int64_t> number = detail::parse_integer(words[i]);
      if (!number || *number < 0 || *number >= static_cast<std::int64_t>(mesh.positions.size())) {
        fail(fmt::format("{} is not a vertex: they are numbered from 0 to {}",
                         detail::quoted(words[i]), mesh.positions.size() - 1));
      }
      edge[i] = static_cast<std::uint32_t>(*number);
    }
    sides.push_back(find_inner_edge(mesh, topology, edge));
    if (sides.back() == kNone)
      fail(fmt::format("the mesh has no edge {} {} between two faces", edge[0], edge[1]));
  }
  return sides;
}

void save_obj(const Mesh& mesh, const std::string& path, const std::string& comment,
              const Poll& poll) {
  AtomicFile file(path);
  ItemPoll asks(poll);
  fmt::memory_buffer line;
  const fmt::appender out(line);
  const auto end_line = [&] {
    asks();
    line.push_back('\n');
    file.write(line.data(), line.size());
    line.clear();
  };

  for (std::size_t begin = 0; begin < comment.size();) {
    const std::size_t end = std::min(comment.find_first_of("\r\n", begin), comment.size());
    fmt::format_to(out, "# {}", std::string_view(comment).substr(begin, end - begin));
    end_line();
    begin = end + 1;
  }
  fmt::format_to(out, "# unit: {:.17g} m", mesh.unit);
  end_line();
  for (const Vec3& p : mesh.positions) {
    fmt::format_to(out, "v {:.17g} {:.17g} {:.17g}", p.x(), p.y(), p.z());
    end_line();
  }
  for (const Vec3& n : mesh.normals) {
    fmt::format_to(out, "vn {:.17g} {:.17g} {:.17g}", n.x(), n.y(), n.z());
    end_line();
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    line.push_back('f');
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      fmt::format_to(out, " {}", mesh.corner_vertex[c] + 1);
      if (!mesh.normals.empty()) fmt::format_to(out, "//{}", mesh.corner_normal[c] + 1);
    }
    end_line();
  }
  file.commit();
}

}  // namespace gliss
