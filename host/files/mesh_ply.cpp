// Stanford PLY: ascii, little or big endian; vertices with x, y, z and nx, ny, nz, faces with
// vertex_indices, tristrips with the same; every other element and property is stepped over.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "gliss/files/mesh_readers.h"
#include "gliss/files/ply_header.h"

namespace gliss::detail {
namespace {

using namespace ply;

// The numbers of the body, one after another, whatever their encoding.
class Body {
 public:
  Body(TextCursor& cursor, Encoding encoding, Report& report)
      : cursor_(cursor), report_(report), encoding_(encoding) {
    if (encoding != Encoding::kAscii) bytes_ = cursor.after_line();
  }

  std::size_t line() const { return encoding_ == Encoding::kAscii ? cursor_.line() : 0; }

  // An item has a line of its own in ascii.
  void begin_item(const Element& element, std::int64_t item) {
    element_ = &element;
    item_ = item;
    if (encoding_ == Encoding::kAscii && !cursor_.next()) fail_truncated();
  }
  void end_item() {
    if (encoding_ == Encoding::kAscii) cursor_.end();
  }

  double number(Type type) {
    if (encoding_ == Encoding::kAscii) return cursor_.number("value");
    report_.poll();
    switch (type) {
      case Type::kInt8:
        return take<std::int8_t>();
      case Type::kUint8:
        return take<std::uint8_t>();
      case Type::kInt16:
        return take<std::int16_t>();
      case Type::kUint16:
        return take<std::uint16_t>();
      case Type::kInt32:
        return take<std::int32_t>();
      case Type::kUint32:
        return take<std::uint32_t>();
      case Type::kFloat32:
        return static_cast<double>(take<float>());
      case Type::kFloat64:
        return take<double>();
    }
    return 0;
  }

  std::int64_t integer(Type type) {
    const double value = number(type);
    if (!std::isfinite(value) || value != std::floor(value)) {
      fail_item(fmt::format("{} is not an integer", value));
    }
    return static_cast<std::int64_t>(std::clamp(value, -0x1p62, 0x1p62));
  }

  // The length of a list.
  std::int64_t length(const Property& property) {
    const std::int64_t value = integer(property.count_type);
    if (value < 0) {
      fail_item(fmt::format("{} of length {}", quoted(property.name), value));
    }
    return value;
  }

  void end() {
    if (encoding_ == Encoding::kAscii) {
      if (cursor_.next()) {
        report_.fail("extra-data", {.line = line()}, "unexpected {} after the last element",
                     quoted(cursor_.word()));
      }
    } else if (!bytes_.empty()) {
      report_.fail("extra-data", {}, "{} bytes after the last element", bytes_.size());
    }
  }

 private:
  template <class T>
  T take() {
    const std::optional<T> number = take_number<T>(
        bytes_, encoding_ == Encoding::kBig ? std::endian::big : std::endian::little);
    if (!number) fail_truncated();
    return *number;
  }

  [[noreturn]] void fail_item(const std::string& what) {
    const auto item = static_cast<std::uint32_t>(item_);
    if (element_->name == "face")
      report_.fail("syntax", {.face = item, .line = line()}, "{}", what);
    report_.fail("syntax", {.line = line()}, "{} {}: {}", printable(element_->name), item_, what);
  }

  [[noreturn]] void fail_truncated() {
    report_.fail("truncated", {}, "the file ends in {} {} of {}", printable(element_->name), item_,
                 element_->count);
  }

  TextCursor& cursor_;
  Report& report_;
  Encoding encoding_;
  std::string_view bytes_;
  const Element* element_ = nullptr;
  std::int64_t item_ = 0;
};

void skip(Body& body, const Property& property) {
  std::int64_t count = property.is_list ? body.length(property) : 1;
  for (; count > 0; --count) body.number(property.type);
}

void read_vertices(Body& body, const Element& element, Mesh& mesh, Report& report) {
  constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
  std::vector<std::size_t> column;  // [property], its place in kNames
  std::array<int, 6> found{};
  for (const Property& property : element.properties) {
    const auto name = std::find(kNames.begin(), kNames.end(), property.name);
    const std::size_t place = static_cast<std::size_t>(name - kNames.begin());
    column.push_back(property.is_list ? kNames.size() : place);
    if (column.back() < found.size()) ++found[place];
  }
  if (std::any_of(found.begin(), found.begin() + 3, [](int n) { return n != 1; })) {
    report.fail("syntax", {.line = element.line}, "the vertices must have one each of x, y and z");
  }
  const bool with_normals =
      std::all_of(found.begin() + 3, found.end(), [](int n) { return n == 1; });
  if (!with_normals && found != decltype(found){1, 1, 1}) {
    report
        .add(Severity::kWarning, "unused-normals", {.line = element.line},
             "normals need one each of nx, ny and nz; what there is of them is ignored")
        .count = static_cast<std::size_t>(element.count);
  }

  for (std::int64_t item = 0; item < element.count; ++item) {
    body.begin_item(element, item);
    std::array<double, 6> value{};
    for (std::size_t i = 0; i < column.size(); ++i) {
      if (column[i] < value.size()) {
        value[column[i]] = body.number(element.properties[i].type);
      } else {
        skip(body, element.properties[i]);
      }
    }
    body.end_item();
    add_vertex({value[0], value[1], value[2]}, body.line(), mesh, report);
    if (!with_normals) continue;
    Vec3 normal(value[3], value[4], value[5]);
    if (!mesh.positions.back().allFinite()) normal = Vec3::UnitZ();  // of no place
    if (!normal.allFinite()) {
      report.fail("non-finite", {.vertex = static_cast<std::uint32_t>(item), .line = body.line()},
                  "normal ({}, {}, {}) is not finite", value[3], value[4], value[5]);
    }
    mesh.normals.push_back(normal);
  }
}

// The triangles of a strip as its vertices come: the last three make one, and every second one is
// turned. Those that name a vertex twice only lead to the next.
struct Strip {
  std::array<std::uint32_t, 2> last{};
  std::size_t count = 0;

  void add(std::uint32_t vertex, std::size_t line, Mesh& mesh, Report& report) {
    auto [a, b] = std::exchange(last, {last[1], vertex});
    if (++count < 3 || a == b || b == vertex || a == vertex) return;
    if (count % 2 == 0) std::swap(a, b);
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, vertex});
    end_face(mesh, line, report);
  }
};

// Faces, or strips of triangles, which -1 parts.
void read_faces(Body& body, const Element& element, Mesh& mesh, Report& report) {
  const bool strips = element.name == "tristrips";
  const auto is_loop = [](const Property& property) {
    return property.is_list && is_integer(property.type) &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  };
  if (std::count_if(element.properties.begin(), element.properties.end(), is_loop) != 1) {
    report.fail("syntax", {.line = element.line},
                "the {} must have one list of integers called vertex_indices",
                strips ? "tristrips" : "faces");
  }
  for (std::int64_t item = 0; item < element.count; ++item) {
    body.begin_item(element, item);
    for (const Property& property : element.properties) {
      if (!is_loop(property)) {
        skip(body, property);
        continue;
      }
      Strip strip;
      for (std::int64_t left = body.length(property); left > 0; --left) {
        const std::int64_t index = body.integer(property.type);
        if (strips && index == -1) {
          strip = Strip();
          continue;
        }
        const std::uint32_t vertex = checked_index(index, mesh, body.line(), report);
        if (strips) {
          strip.add(vertex, body.line(), mesh, report);
        } else {
          mesh.corner_vertex.push_back(vertex);
        }
      }
    }
    body.end_item();
    if (!strips) end_face(mesh, body.line(), report);
  }
}

}  // namespace

bool is_binary_ply(std::string_view text) {
  return text.starts_with("ply") &&
         text.substr(0, text.find("end_header")).find("format binary") != text.npos;
}

void read_ply(std::string_view text, Mesh& mesh, Report& report) {
  TextCursor cursor(text, {}, report);
  const Header header = read_ply_header(cursor, report);
  Body body(cursor, header.encoding, report);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(body, element, mesh, report);
    } else if (element.name == "face" || element.name == "tristrips") {
      read_faces(body, element, mesh, report);
    } else {
      if (element.properties.empty() && element.count > 0) {
        report.fail("syntax", {.line = element.line}, "element {} has no properties",
                    quoted(element.name));
      }
      for (std::int64_t item = 0; item < element.count; ++item) {
        body.begin_item(element, item);
        for (const Property& property : element.properties) skip(body, property);
        body.end_item();
      }
    }
  }
  body.end();
  if (!mesh.normals.empty()) mesh.corner_normal = mesh.corner_vertex;
}

}  // namespace gliss::detail
