// Views of numbers and vectors in memory that is the caller's, in whatever order it keeps them.
#pragma once

#include <cstddef>
#include <type_traits>

namespace gliss {

// Numbers `stride` bytes apart: an array, a column of a table of rows, or a member of structs.
// Null: not there, or not asked for.
template <class T>
struct Strided {
  T* first = nullptr;
  std::ptrdiff_t stride = sizeof(T);

  explicit operator bool() const { return first != nullptr; }
  operator Strided<const T>() const requires(!std::is_const_v<T>) { return {first, stride}; }
  bool is_dense() const { return stride == sizeof(T); }
  T& operator[](std::size_t i) const {
    using Byte = std::conditional_t<std::is_const_v<T>, const std::byte, std::byte>;
    return *reinterpret_cast<T*>(reinterpret_cast<Byte*>(first) +
                                 static_cast<std::ptrdiff_t>(i) * stride);
  }
  // The elements from the i-th on.
  Strided from(std::size_t i) const {
    return first == nullptr ? *this : Strided{&(*this)[i], stride};
  }
};

// Vectors by their coordinates, three columns.
template <class T>
struct StridedVectors {
  Strided<T> x, y, z;

  explicit operator bool() const { return bool(x); }
  operator StridedVectors<const T>() const requires(!std::is_const_v<T>) { return {x, y, z}; }
  const Strided<T>& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  StridedVectors from(std::size_t i) const { return {x.from(i), y.from(i), z.from(i)}; }
};

// Three arrays: one for each coordinate.
template <class T>
StridedVectors<T> strided_vectors(T* x, T* y, T* z) {
  return {{x}, {y}, {z}};
}
// Vectors one after the other, `stride` bytes from one to the next: rows x, y, z of a table, or
// members of structs.
template <class T>
StridedVectors<T> strided_vectors(T* first, std::ptrdiff_t stride = 3 * sizeof(T)) {
  return {{first, stride}, {first + 1, stride}, {first + 2, stride}};
}

}  // namespace gliss
