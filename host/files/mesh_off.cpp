// Object File Format: OFF, with normals, colours and texture of the vertices ([ST][C][N]OFF), as
// text or binary. What is on a line of text must be accounted for, and all bytes.
#include <algorithm>

#include "gliss/files/mesh_readers.h"

namespace gliss::detail {
namespace {

struct Columns {
  bool normals = false;
  bool colours = false;
  bool texture = false;
};

Columns read_off_header(TextCursor& cursor, Report& report) {
  const std::string_view header = cursor.next() ? cursor.word() : std::string_view();
  Columns columns;
  std::string_view prefix = header;
  if (prefix.ends_with("OFF")) {
    prefix.remove_suffix(3);
    columns.texture = prefix.starts_with("ST");
    if (columns.texture) prefix.remove_prefix(2);
    for (; !prefix.empty(); prefix.remove_prefix(1)) {
      bool& column = prefix[0] == 'N' ? columns.normals : columns.colours;
      if ((prefix[0] != 'N' && prefix[0] != 'C') || column) break;
      column = true;
    }
  }
  if (header.empty() || !prefix.empty()) {
    // 4 and n: dimensions
    const bool foreign =
        header.ends_with("OFF") && prefix.find_first_not_of("STCN4n") == std::string_view::npos;
    report.fail(foreign ? "unsupported" : "syntax",
                {.line = std::max<std::size_t>(1, cursor.line())},
                "the header must be OFF, COFF, NOFF or STOFF, not {}", quoted(header));
  }
  return columns;
}

// To the end of the line; at most so many.
std::size_t skip_numbers(TextCursor& cursor, std::size_t most, Report& report) {
  std::size_t count = 0;
  for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word(), ++count) {
    if (!parse_number(word) || count == most) {
      report.fail("extra-data", {.line = cursor.line()}, "unexpected {}", quoted(word));
    }
  }
  return count;
}

// Colours are 3 or 4 numbers, texture is 2 behind them.
void skip_colour_and_texture(TextCursor& cursor, const Columns& columns, Report& report) {
  const std::size_t texture = columns.texture ? 2 : 0, colour = columns.colours ? 4 : 0,
                    count = skip_numbers(cursor, colour + texture, report);
  if (count == colour + texture || (columns.colours && count + 1 == colour + texture)) return;
  report.fail("syntax", {.line = cursor.line()}, "a {} of {} numbers",
              !columns.texture   ? "colour"
              : !columns.colours ? "texture"
                                 : "colour and texture",
              count);
}

// A vertex may go on over lines and share one with others, but where the first of a line is not
// whole on it, it has to end with another one: a number is too many or missing otherwise. True if
// any line has several.
bool read_off_vertices(TextCursor& cursor, std::int64_t count, const Columns& columns, Mesh& mesh,
                       Report& report) {
  std::size_t before = 0;  // on the line of this vertex
  bool share_lines = false;
  for (std::int64_t i = 0; i < count; ++i) {
    before = cursor.has_word() ? before + 1 : 0;
    if (before == 0 && !cursor.next()) {
      report.fail("truncated", {}, "the file ends after {} of {} vertices", i, count);
    }
    const std::size_t line = cursor.line();
    add_vertex(cursor.numbers("coordinate"), line, mesh, report);
    if (columns.normals) mesh.normals.push_back(cursor.vector("normal"));
    share_lines |= before > 0;
    const bool goes_on = cursor.line() != line;
    if (goes_on && before == 1) {
      report.fail("extra-data", {.line = line}, "a number too many after vertex {}", i - 1);
    }
    if (columns.colours || columns.texture) {
      skip_colour_and_texture(cursor, columns, report);
    } else if (goes_on && before == 0 && cursor.has_word()) {
      report.fail("syntax", {.line = line}, "a number of vertex {} is missing", i);
    }
  }
  cursor.end();
  return share_lines;
}

// A face begins a line, and its colour ends one: 3 or 4 numbers, or an index, or nothing.
void read_off_faces(TextCursor& cursor, std::int64_t count, bool after_shared_lines, Mesh& mesh,
                    Report& report) {
  const std::string_view sides_name =
      after_shared_lines
          ? "after lines of several vertices, or of columns that the header does not "
            "name, the number of sides"
          : "number of sides";
  std::string goes_on;  // tells the first face that does so
  for (std::int64_t i = 0; i < count; ++i) {
    if (!cursor.next()) {
      report.fail("truncated", {}, "the file ends after {} of {} faces{}", i, count, goes_on);
    }
    const std::size_t line = cursor.line();
    const std::int64_t sides = cursor.integer(sides_name);
    if (sides < 0) report.fail("syntax", {.line = line}, "a face of {} sides", sides);
    for (std::int64_t k = 0; k < sides; ++k) {
      const std::int64_t index = cursor.integer("vertex index");
      mesh.corner_vertex.push_back(checked_index(index, mesh, cursor.line(), report));
    }
    if (cursor.line() != line && goes_on.empty()) {
      goes_on =
          fmt::format("; face {} goes on over line {}, or has fewer than {} sides", i, line, sides);
    }
    const std::size_t colour = skip_numbers(cursor, 4, report);
    if (colour == 2) report.fail("syntax", {.line = cursor.line()}, "a colour of 2 numbers");
    if (colour == 1) {  // or the number of sides is one too low
      report.add(Severity::kWarning, "extra-columns",
                 {.face = static_cast<std::uint32_t>(i), .line = cursor.line()},
                 "the number after its vertices is taken for a colour");
    }
    end_face(mesh, line, report);
  }
  if (cursor.next()) {
    report.fail("extra-data", {.line = cursor.line()},
                "unexpected {} after the {} faces that the header counts", quoted(cursor.word()),
                count);
  }
}

// The next word, on whatever line; empty: there is none.
std::string_view next_word(TextCursor& cursor) {
  const std::string_view word = cursor.word();
  return word.empty() && cursor.next() ? cursor.word() : word;
}

bool skip_words(TextCursor& cursor, std::int64_t count) {
  while (count-- > 0) {
    if (next_word(cursor).empty()) return false;
  }
  return true;
}

// True if what follows the counts is numbers of vertices and of faces without colours, on fewer
// lines than there are items: then lines mean nothing.
bool is_stream(TextCursor cursor, std::int64_t vertices, std::int64_t faces, const Columns& columns,
               Report& report) {
  const std::string_view text = cursor.rest();
  const auto most = static_cast<std::int64_t>(text.size());
  if (columns.colours || columns.texture || vertices > most || faces > most) return false;
  std::int64_t lines = 0;
  for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1)) {
    report.poll();
    if (++lines >= vertices + faces) return false;
  }
  if (!skip_words(cursor, vertices * (columns.normals ? 6 : 3))) return false;
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::int64_t sides = parse_integer(next_word(cursor)).value_or(-1);
    if (sides < 0 || !skip_words(cursor, sides)) return false;
  }
  return next_word(cursor).empty();
}

// True if the next statement is one word, as where each count has a line.
bool has_one_word(TextCursor cursor) {
  return cursor.next() && !cursor.word().empty() && !cursor.has_word();
}

void read_stream(TextCursor& cursor, std::int64_t vertices, std::int64_t faces,
                 const Columns& columns, Mesh& mesh, Report& report) {
  for (std::int64_t i = 0; i < vertices; ++i) {
    const Vec3 position = cursor.numbers("coordinate");
    add_vertex(position, cursor.line(), mesh, report);
    if (columns.normals) mesh.normals.push_back(cursor.vector("normal"));
  }
  for (std::int64_t i = 0; i < faces; ++i) {
    const std::int64_t sides = cursor.integer("number of sides");
    const std::size_t line = cursor.line();
    for (std::int64_t k = 0; k < sides; ++k)
      mesh.corner_vertex.push_back(
          checked_index(cursor.integer("vertex index"), mesh, cursor.line(), report));
    end_face(mesh, line, report);
  }
}

// Geomview's numbers are big-endian, and each face ends with its colour. PMP writes those of its
// machine, which is taken for little-endian, and no colours of faces.
class BinaryOff {
 public:
  BinaryOff(std::string_view bytes, const Columns& columns, Mesh& mesh, Report& report)
      : bytes_(bytes),
        columns_(columns),
        floats_(3 + (columns.normals ? 3 : 0) + (columns.colours ? 4 : 0) +
                (columns.texture ? 2 : 0)),
        mesh_(mesh),
        report_(report) {
    if (!has_room(std::endian::big) && has_room(std::endian::little)) order_ = std::endian::little;
  }

  void read() {
    if (bytes_.size() < 3 * 4) report_.fail("truncated", {}, "the file ends before its counts");
    const std::int64_t vertices = integer(), faces = integer();
    integer();  // the number of edges is often wrong, and not needed
    if (vertices < 0 || faces < 0) {
      report_.fail("syntax", {}, "the header counts {} vertices and {} faces", vertices, faces);
    }
    read_items("vertices", vertices, [&] { read_vertex(); });
    read_items("faces", faces, [&] { read_face(); });
    if (!bytes_.empty()) {
      report_.fail("extra-data", {}, "{} bytes after the {} faces that the header counts",
                   bytes_.size(), faces);
    }
  }

 private:
  template <class T>
  T take() {
    const std::optional<T> number = take_number<T>(bytes_, order_);
    if (!number) {
      report_.fail("truncated", {}, "the file ends after {} of {} {}", done_.items, done_.of,
                   done_.name);
    }
    return *number;
  }
  std::int64_t integer() { return take<std::int32_t>(); }

  // True if there may be as many vertices as the first number says in this order.
  bool has_room(std::endian order) const {
    std::string_view bytes = bytes_;
    const std::int64_t count = take_number<std::int32_t>(bytes, order).value_or(-1);
    return count >= 0 && 4 * count * floats_ <= static_cast<std::int64_t>(bytes.size());
  }

  template <class Read>
  void read_items(std::string_view name, std::int64_t count, const Read& read) {
    for (std::int64_t i = 0; i < count; ++i) {
      report_.poll();
      done_ = {i, count, name};
      read();
    }
  }

  void read_vertex() {
    std::array<float, 12> value{};
    for (std::int64_t i = 0; i < floats_; ++i) value[i] = take<float>();
    add_vertex(vector_at(&value[0]), 0, mesh_, report_);
    if (!columns_.normals) return;
    const Vec3 normal = vector_at(&value[3]);
    if (!normal.allFinite()) {
      report_.fail("non-finite", {.vertex = static_cast<std::uint32_t>(mesh_.positions.size() - 1)},
                   "normal ({}, {}, {}) is not finite", normal.x(), normal.y(), normal.z());
    }
    mesh_.normals.push_back(normal);
  }

  void read_face() {
    const std::int64_t sides = integer();
    if (sides < 0) report_.fail("syntax", place(), "{} sides", sides);
    for (std::int64_t k = 0; k < sides; ++k) {
      report_.poll();
      mesh_.corner_vertex.push_back(checked_index(integer(), mesh_, 0, report_));
    }
    if (order_ == std::endian::big) {
      const std::int64_t colour = integer();
      if (colour < 0 || colour > 4)
        report_.fail("syntax", place(), "a colour of {} numbers", colour);
      for (std::int64_t k = 0; k < colour; ++k) take<float>();
    }
    end_face(mesh_, 0, report_);
  }

  Report::Place place() const { return {.face = static_cast<std::uint32_t>(mesh_.face_count())}; }

  std::string_view bytes_;
  Columns columns_;
  std::int64_t floats_;  // of a vertex
  Mesh& mesh_;
  Report& report_;
  std::endian order_ = std::endian::big;
  struct {
    std::int64_t items = 0, of = 0;
    std::string_view name;
  } done_;
};

}  // namespace

bool is_binary_off(std::string_view text) {
  return text.substr(0, text.find_first_of("\r\n")).find("OFF BINARY") != text.npos;
}

void read_off(std::string_view text, Mesh& mesh, Report& report) {
  TextCursor cursor(text, {.comment = '#'}, report);
  const Columns columns = read_off_header(cursor, report);

  // The counts may follow the keyword on its line.
  std::string_view first = cursor.word();
  if (first == "BINARY") {
    cursor.end();
    BinaryOff(cursor.after_line(), columns, mesh, report).read();
  } else {
    if (first.empty() && !cursor.next())
      report.fail("truncated", {}, "the file ends before its counts");
    if (first.empty()) first = cursor.word();
    const std::optional<std::int64_t> vertices = parse_integer(first);
    if (!vertices || *vertices < 0) {
      report.fail("syntax", {.line = cursor.line()}, "{} is not a number of vertices",
                  quoted(first));
    }
    const bool counts_have_lines = !cursor.has_word() && has_one_word(cursor);
    if (counts_have_lines) cursor.read_on_over_lines();
    const std::int64_t faces = cursor.integer("number of faces");
    if (faces < 0) report.fail("syntax", {.line = cursor.line()}, "{} faces", faces);
    // The number of edges is often wrong, or missing behind the others, and not needed.
    if (counts_have_lines)
      cursor.integer("number of edges");
    else
      cursor.word();
    cursor.read_on_over_lines();
    if (is_stream(cursor, *vertices, faces, columns, report)) {
      read_stream(cursor, *vertices, faces, columns, mesh, report);
    } else {
      cursor.end();
      const bool share_lines = read_off_vertices(cursor, *vertices, columns, mesh, report);
      read_off_faces(cursor, faces, share_lines, mesh, report);
    }
  }
  if (columns.normals) mesh.corner_normal = mesh.corner_vertex;
}

}  // namespace gliss::detail
