// Object File Format: OFF, with colours (COFF), normals (NOFF) or both (NCOFF, CNOFF). One vertex
// or face a line; what is on it must be accounted for.
#include <algorithm>

#include "gliss/files/mesh_readers.h"

namespace gliss::detail {
namespace {

struct Columns {
  bool normals = false;
  bool colours = false;
};

Columns read_off_header(TextCursor& cursor, Report& report) {
  const std::string_view header = cursor.next() ? cursor.word() : std::string_view();
  Columns columns;
  std::string_view prefix = header;
  if (prefix.ends_with("OFF")) {
    prefix.remove_suffix(3);
    for (; !prefix.empty(); prefix.remove_prefix(1)) {
      bool& column = prefix[0] == 'N' ? columns.normals : columns.colours;
      if ((prefix[0] != 'N' && prefix[0] != 'C') || column) break;
      column = true;
    }
  }
  if (header.empty() || !prefix.empty()) {
    // ST: texture, 4 and n: dimensions
    const bool foreign =
        header.ends_with("OFF") && prefix.find_first_not_of("STCN4n") == std::string_view::npos;
    report.fail(foreign ? "unsupported" : "syntax",
                {.line = std::max<std::size_t>(1, cursor.line())},
                "the header must be OFF, COFF or NOFF, not {}", quoted(header));
  }
  return columns;
}

// Colours are 3 or 4 numbers (a face may also have one index, or none).
std::size_t skip_colour(TextCursor& cursor, bool of_face, Report& report) {
  std::size_t count = 0;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word(), ++count) {
    if (!parse_number(word) || count == 4) {
      report.fail("extra-data", {.line = cursor.line()}, "unexpected {}", quoted(word));
    }
  }
  if (count == 2 || (!of_face && count < 3)) {
    report.fail("syntax", {.line = cursor.line()}, "a colour of {} numbers", count);
  }
  return count;
}

}  // namespace

void read_off(std::string_view text, Mesh& mesh, Report& report) {
  TextCursor cursor(text, {.comment = '#'}, report);
  const Columns columns = read_off_header(cursor, report);

  // The counts may follow the keyword on its line.
  std::string_view first = cursor.word();
  if (first == "BINARY") {
    report.fail("unsupported", {.line = cursor.line()}, "binary OFF cannot be read");
  }
  if (first.empty() && !cursor.next())
    report.fail("truncated", {}, "the file ends before its counts");
  if (first.empty()) first = cursor.word();
  const std::optional<std::int64_t> vertices = parse_integer(first);
  if (!vertices || *vertices < 0) {
    report.fail("syntax", {.line = cursor.line()}, "{} is no number of vertices", quoted(first));
  }
  const std::int64_t faces = cursor.integer("number of faces");
  if (faces < 0) report.fail("syntax", {.line = cursor.line()}, "{} faces", faces);
  if (!cursor.word().empty()) cursor.end();  // the number of edges is often wrong, and not needed

  for (std::int64_t i = 0; i < *vertices; ++i) {
    if (!cursor.next()) {
      report.fail("truncated", {}, "the file ends after {} of {} vertices", i, *vertices);
    }
    add_vertex(cursor.numbers("coordinate"), cursor.line(), mesh, report);
    if (columns.normals) mesh.normals.push_back(cursor.vector("normal"));
    if (columns.colours) skip_colour(cursor, false, report);
    cursor.end();
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    if (!cursor.next()) {
      report.fail("truncated", {}, "the file ends after {} of {} faces", i, faces);
    }
    const std::int64_t sides = cursor.integer("number of sides");
    if (sides < 0) report.fail("syntax", {.line = cursor.line()}, "a face of {} sides", sides);
    for (std::int64_t k = 0; k < sides; ++k) {
      const std::int64_t index = cursor.integer("vertex index");
      mesh.corner_vertex.push_back(checked_index(index, mesh, cursor.line(), report));
    }
    if (skip_colour(cursor, true, report) == 1) {  // or the number of sides is one too low
      report.add(Severity::kWarning, "extra-columns",
                 {.face = static_cast<std::uint32_t>(i), .line = cursor.line()},
                 "the number after its vertices is taken for a colour");
    }
    end_face(mesh, cursor.line(), report);
  }
  if (cursor.next()) {
    report.fail("extra-data", {.line = cursor.line()},
                "unexpected {} after the {} faces that the header counts", quoted(cursor.word()),
                faces);
  }
  if (columns.normals) mesh.corner_normal = mesh.corner_vertex;
}

}  // namespace gliss::detail
