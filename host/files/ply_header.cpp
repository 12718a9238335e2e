#include "gliss/files/ply_header.h"

#include <algorithm>
#include <array>

namespace gliss::detail::ply {
namespace {

Type type_of(std::string_view word, const TextCursor& cursor, Report& report) {
  constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (word == kNames[i][0] || word == kNames[i][1]) return static_cast<Type>(i);
  }
  report.fail("syntax", {.line = cursor.line()}, "unknown type {}", quoted(word));
}

Encoding read_encoding(TextCursor& cursor, Report& report) {
  const std::string_view word = cursor.word();
  if (word == "ascii") return Encoding::kAscii;
  if (word == "binary_little_endian") return Encoding::kLittle;
  if (word == "binary_big_endian") return Encoding::kBig;
  report.fail("syntax", {.line = cursor.line()}, "unknown format {}", quoted(word));
}

Property read_property(TextCursor& cursor, Report& report) {
  Property property;
  std::string_view word = cursor.word();
  if (word == "list") {
    property.is_list = true;
    property.count_type = type_of(cursor.word(), cursor, report);
    if (!is_integer(property.count_type)) {
      report.fail("syntax", {.line = cursor.line()}, "the length of a list must be an integer");
    }
    word = cursor.word();
  }
  property.type = type_of(word, cursor, report);
  property.name = cursor.word();
  if (property.name.empty()) {
    report.fail("syntax", {.line = cursor.line()}, "a property without a name");
  }
  return property;
}

Element read_element(TextCursor& cursor, const Header& header, Report& report) {
  Element element;
  element.line = cursor.line();
  element.name = cursor.word();
  element.count = cursor.integer("number of items");
  if (element.count < 0) report.fail("syntax", {.line = element.line}, "{} items", element.count);
  const auto has_name = [&](const Element& other) { return other.name == element.name; };
  if (std::any_of(header.elements.begin(), header.elements.end(), has_name)) {
    report.fail("syntax", {.line = element.line}, "a second element {}", quoted(element.name));
  }
  return element;
}

}  // namespace

Header read_ply_header(TextCursor& cursor, Report& report) {
  if (!cursor.next() || cursor.word() != "ply") {
    report.fail("syntax", {.line = 1}, "the first line must be 'ply'");
  }
  Header header;
  bool has_format = false;
  while (cursor.next()) {
    const std::string_view keyword = cursor.word();
    if (keyword == "end_header") {
      if (!has_format) report.fail("syntax", {.line = cursor.line()}, "no format is given");
      return header;
    }
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      if (has_format) report.fail("syntax", {.line = cursor.line()}, "a second format");
      header.encoding = read_encoding(cursor, report);
      if (cursor.number("version") != 1.0) {
        report.fail("unsupported", {.line = cursor.line()}, "only version 1.0 is known");
      }
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(cursor, header, report));
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(cursor, report));
    } else {
      report.fail("syntax", {.line = cursor.line()}, "unexpected {} in the header",
                  quoted(keyword));
    }
    cursor.end();
  }
  report.fail("truncated", {}, "the header has no end");
}

}  // namespace gliss::detail::ply
