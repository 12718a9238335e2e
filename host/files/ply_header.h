// The header of a PLY file: what its body holds, in which encoding. Private to host/.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "gliss/files/mesh_readers.h"

namespace gliss::detail::ply {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
inline bool is_integer(Type type) { return type < Type::kFloat32; }

enum class Encoding { kAscii, kLittle, kBig };

struct Property {
  std::string_view name;
  Type type{};
  bool is_list = false;
  Type count_type{};
};

struct Element {
  std::string_view name;
  std::int64_t count = 0;
  std::size_t line = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding{};
  std::vector<Element> elements;
};

// Fails unless the text starts with a whole header; leaves the cursor on its last line. The names
// are views of the text.
Header read_ply_header(TextCursor& cursor, Report& report);

}  // namespace gliss::detail::ply
