// NumPy arrays in and out without a copy: views of those that come, and new ones that own their
// memory.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <initializer_list>
#include <string>

#include "gliss/base/strided.h"
#include "gliss/base/vector.h"
#include "gliss/query/query.h"

namespace gliss::python {

namespace py = pybind11;

// Numbers as the package hands them over: float64 of any strides, aligned.
using Reals = py::array_t<double>;

// Requires an array (n, columns) of finite numbers. Throws ValueError, which names the row; `name`
// starts the line.
void require_rows(const Reals& array, const char* name, py::ssize_t columns);

// The same of points (n, 3), of which no coordinate is beyond kMostCoordinate: distances would
// overflow there.
void require_points(const Reals& array, const char* name);

// Column `i` of an array of rows; valid as long as the array.
inline Strided<const double> column(const Reals& rows, py::ssize_t i) {
  const auto* first = static_cast<const std::byte*>(static_cast<const void*>(rows.data()));
  return {reinterpret_cast<const double*>(first + i * rows.strides(1)), rows.strides(0)};
}
inline StridedVectors<const double> vectors(const Reals& rows) {
  return {column(rows, 0), column(rows, 1), column(rows, 2)};
}

// One point, three numbers as require_points has them: an array (3,) or a sequence. Throws
// ValueError, and TypeError, also for a masked array.
Vec3 point_of(py::handle object, const char* name);

// A new array (n,) or (n, columns), its first number, and its columns.
template <class T>
class NewArray {
 public:
  explicit NewArray(std::size_t n) : array_(static_cast<py::ssize_t>(n)) {}
  NewArray(std::size_t n, std::size_t columns)
      : array_({static_cast<py::ssize_t>(n), static_cast<py::ssize_t>(columns)}),
        columns_(columns) {}

  T* data() { return array_.mutable_data(); }
  Strided<T> column(std::size_t i = 0) {
    return {data() + i, static_cast<std::ptrdiff_t>(columns_ * sizeof(T))};
  }
  StridedVectors<T> vectors() { return {column(0), column(1), column(2)}; }
  Eigen::Map<Vec3> row(std::size_t i) { return Eigen::Map<Vec3>(data() + 3 * i); }  // of 3 columns
  const py::array_t<T>& array() const { return array_; }

 private:
  py::array_t<T> array_;
  std::size_t columns_ = 1;
};

py::array_t<double> array_of(const Vec3& vector);

// Contacts as new arrays: what answers about many points and ticks have in common.
class NewContacts {
 public:
  explicit NewContacts(std::size_t n);

  // The columns that it has; valid as long as the arrays.
  ContactArrays<double> columns();
  void set(std::size_t i, const Contact& contact);
  // Puts all but the flags, which come later, under their names.
  void put(py::dict& out) const;
  const py::array_t<std::uint32_t>& flags() const { return flags_.array(); }

 private:
  NewArray<double> point_, normal_, distance_, domain_;
  NewArray<std::uint32_t> face_, flags_;
  NewArray<bool> touching_;
};

}  // namespace gliss::python
