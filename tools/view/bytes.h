// Numbers as bytes of a message to the page, little-endian as browsers have them.
#pragma once

#include <bit>
#include <string>

namespace gliss::tools {

static_assert(std::endian::native == std::endian::little);

template <class Number>
void append_bytes(std::string& bytes, const Number& number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <class Vector>
void append_floats(std::string& bytes, const Vector& vector) {
  for (int i = 0; i < 3; ++i) append_bytes(bytes, static_cast<float>(vector[i]));
}

}  // namespace gliss::tools
