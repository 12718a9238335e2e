// Wavefront OBJ: v, vn, f and s; everything that is no geometry is skipped, never a face.
#include <algorithm>
#include <array>

#include "gliss/files/mesh_readers.h"

namespace gliss::detail {
namespace {

struct Counts {
  std::size_t faces = 0;
  std::size_t corners = 0;
};

class ObjReader {
 public:
  ObjReader(std::string_view text, Mesh& mesh, Report& report)
      : mesh_(mesh), report_(report), cursor_(text, {.comment = '#', .continued = true}, report) {}

  void read() {
    while (cursor_.next()) read_statement(cursor_.word());
    check_indices();
    drop_unused_normals();
  }

 private:
  void read_statement(std::string_view keyword) {
    if (keyword == "v") return read_vertex();
    if (keyword == "f" || keyword == "fo") return read_face();  // fo: before version 3
    if (keyword == "vn") {
      mesh_.normals.push_back(cursor_.vector("normal"));
      return cursor_.end();
    }
    if (keyword == "s") return read_group();
    constexpr std::array kSkipped{"vt", "o", "g", "usemtl", "mtllib"};
    if (std::find(kSkipped.begin(), kSkipped.end(), keyword) == kSkipped.end()) {
      report_.add(Severity::kWarning, "unknown-statement", {.line = cursor_.line()},
                  "statement {} is ignored", quoted(keyword));
    }
  }

  void read_vertex() {
    add_vertex(cursor_.numbers("coordinate"), cursor_.line(), mesh_, report_);
    const std::string_view first = cursor_.word();
    if (first.empty()) return;
    std::size_t extra = 1;
    while (!cursor_.word().empty()) ++extra;
    if (extra == 1 && parse_number(first) != 1.0) {
      report_.add(Severity::kWarning, "ignored-weight", {.line = cursor_.line()},
                  "the weight w = {} of a vertex is ignored", quoted(first));
    } else if (extra == 2 || extra > 4) {  // 3 and 4 are colours
      report_.add(Severity::kWarning, "extra-columns", {.line = cursor_.line()},
                  "{} numbers after the coordinates of a vertex are ignored", extra);
    }
  }

  // The smoothing group of the faces that follow: a number, or 0 or "off" for none. Only creases by
  // groups ask for it, so that another word is no error.
  void read_group() {
    const auto none = std::int64_t{0}, most = std::int64_t{kNone};
    group_ = static_cast<std::uint32_t>(
        std::clamp(parse_integer(cursor_.word()).value_or(none), none, most));
    mesh_.face_group.resize(mesh_.face_count(), 0);
    has_groups_ = true;
  }

  void read_face() {
    for (std::string_view word = cursor_.word(); !word.empty(); word = cursor_.word()) {
      read_corner(word);
    }
    end_face(mesh_, cursor_.line(), report_);
    if (has_groups_) mesh_.face_group.push_back(group_);
  }

  // v, v/vt, v//vn or v/vt/vn; vt and vn may be empty, as Wings3D writes them.
  void read_corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size()),
                      second = std::min(word.find('/', slash + 1), word.size());
    const auto from = [&](std::size_t at) { return word.substr(std::min(at + 1, word.size())); };
    const std::string_view texture = from(slash).substr(0, second - slash - 1),
                           normal = from(second);
    if (!texture.empty() && !parse_integer(texture)) fail_corner(word);
    mesh_.corner_vertex.push_back(
        index(word.substr(0, slash), word, "vertex", "vertices", mesh_.positions.size()));
    mesh_.corner_normal.push_back(
        normal.empty() ? kNone : index(normal, word, "normal", "normals", mesh_.normals.size()));
  }

  // From 1 upwards, or from -1 (the latest one) downwards, to 0 upwards.
  std::uint32_t index(std::string_view text, std::string_view word, std::string_view name,
                      std::string_view plural, std::size_t count) {
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value) fail_corner(word);
    const std::int64_t index = *value < 0 ? static_cast<std::int64_t>(count) + *value : *value - 1;
    if (index < 0 || index >= static_cast<std::int64_t>(kNone)) {
      report_.fail(fmt::format("{}-index", name), place(), "{} index {} is out of range ({} {}){}",
                   name, printable(text), count, plural, *value == 0 ? ": OBJ counts from 1" : "");
    }
    return static_cast<std::uint32_t>(index);
  }

  [[noreturn]] void fail_corner(std::string_view word) {
    report_.fail("syntax", place(), "{} is not a corner (v, v/vt, v//vn or v/vt/vn)", quoted(word));
  }

  Report::Place place() const {
    return {.face = static_cast<std::uint32_t>(mesh_.face_count()), .line = cursor_.line()};
  }

  // A face may come before its vertices, so positive indices are looked up at the end; the message
  // names them as the file does, from 1.
  void check_indices() {
    for (std::uint32_t face = 0; face < mesh_.face_count(); ++face) {
      for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c) {
        const std::size_t vertex = mesh_.corner_vertex[c];
        if (vertex >= mesh_.positions.size()) {
          report_.add(Severity::kError, "vertex-index", {.face = face},
                      "vertex index {} is out of range ({} vertices)", vertex + 1,
                      mesh_.positions.size());
        }
        std::uint32_t& normal = mesh_.corner_normal[c];
        if (normal != kNone && normal >= mesh_.normals.size()) {
          report_.add(report_.mended, "normal-index", {.face = face},
                      "normal index {} is out of range ({} normals)", normal + 1,
                      mesh_.normals.size());
          normal = kNone;
        }
      }
    }
    report_.stop_on_error();
  }

  void drop_unused_normals() {
    const auto is_none = [](std::uint32_t normal) { return normal == kNone; };
    if (!std::all_of(mesh_.corner_normal.begin(), mesh_.corner_normal.end(), is_none)) return;
    if (!mesh_.normals.empty()) {
      report_
          .add(Severity::kWarning, "unused-normals", {}, "no face uses the {} normals",
               mesh_.normals.size())
          .count = mesh_.normals.size();
    }
    mesh_.normals.clear();
    mesh_.corner_normal.clear();
  }

  Mesh& mesh_;
  Report& report_;
  TextCursor cursor_;
  std::uint32_t group_ = 0;
  bool has_groups_ = false;
};

// The lines of a text, of any line ending.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ == text_.size(); }
  // Takes the next line, without its ending.
  std::string_view take() {
    feed_ = next(feed_, '\n');
    return_ = next(return_, '\r');
    const std::string_view line = text_.substr(at_, std::min(feed_, return_) - at_);
    at_ += line.size();
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : at_end() ? 0 : 1;
    return line;
  }

 private:
  // Finds where `c` comes next. `found` is where it was found last: if that still lies ahead, the
  // text is not searched again.
  std::size_t next(std::size_t found, char c) const {
    return found != kUnknown && found >= at_ ? found : std::min(text_.find(c, at_), text_.size());
  }

  static constexpr std::size_t kUnknown = std::string_view::npos;
  std::string_view text_;
  std::size_t at_ = 0, feed_ = kUnknown, return_ = kUnknown;
};

// Cuts the next word off a line; empty: there is none.
std::string_view take_word(std::string_view& line) {
  const auto begin = std::find_if_not(line.begin(), line.end(), is_blank),
             end = std::find_if(begin, line.end(), is_blank);
  line.remove_prefix(static_cast<std::size_t>(end - line.begin()));
  return {begin, end};
}

// Counts again in another way, so that a slip of the reader shows. An "f" that starts a joined line
// counts as well: whatever the statement before says, it must not vanish in silence.
Counts count_faces(std::string_view text, Report& report) {
  Counts counts;
  bool in_face = false;
  bool joined = false;  // the line before ended in a backslash
  for (Lines lines(text); !lines.at_end();) {
    report.poll();
    std::string_view line = lines.take();
    const std::size_t comment = line.find('#');
    const bool joins = comment == std::string_view::npos && line.ends_with('\\');
    line = line.substr(0, comment);
    if (joins) line.remove_suffix(1);

    const std::string_view first = take_word(line);
    const bool starts = first == "f" || first == "fo";
    in_face = starts || (joined && in_face);
    joined = joins;
    if (!in_face) continue;
    counts.faces += starts;
    counts.corners += !starts && !first.empty();  // a keyword is no corner
    while (!take_word(line).empty()) ++counts.corners;
  }
  return counts;
}

}  // namespace

void read_obj(std::string_view text, Mesh& mesh, Report& report) {
  ObjReader(text, mesh, report).read();
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const Counts counts = count_faces(text, report);
  if (counts.faces != mesh.face_count() || counts.corners != mesh.corner_vertex.size()) {
    report.fail("count-mismatch", {},
                "the file has {} faces with {} corners, but {} with {} were read", counts.faces,
                counts.corners, mesh.face_count(), mesh.corner_vertex.size());
  }
}

}  // namespace gliss::detail
