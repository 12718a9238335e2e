#include "arrays.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "gliss/mesh/mesh.h"

namespace gliss::python {
namespace {

std::string shape_text(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

bool is_real(char kind) { return kind == 'f' || kind == 'i' || kind == 'u'; }

// True if an array has a mask. NumPy's own class, which has none, is known at once.
bool has_mask(py::handle object) {
  static const PyTypeObject* const plain = Py_TYPE(py::array_t<double>(0).ptr());
  return Py_TYPE(object.ptr()) != plain && py::isinstance<py::array>(object) &&
         py::hasattr(object, "mask");
}

// Requires rows of numbers whose size is `most` at most.
void require_rows(const Reals& array, const char* name, py::ssize_t columns, double most) {
  if (array.ndim() != 2 || array.shape(1) != columns)
    throw py::value_error(
        fmt::format("{}: expected shape (n, {}), found {}", name, columns, shape_text(array)));
  for (py::ssize_t k = 0; k < columns; ++k) {
    const Strided<const double> values = column(array, k);
    const auto rows = static_cast<std::size_t>(array.shape(0));
    for (std::size_t i = 0; i < rows; ++i) {
      if (std::abs(values[i]) <= most) continue;
      throw py::value_error(
          std::isfinite(values[i])
              ? fmt::format("{}: {:.3g} in row {} is beyond {:g}, where distances overflow", name,
                            values[i], i, most)
              : fmt::format("{}: expected finite numbers, found {} in row {}", name, values[i], i));
    }
  }
}

}  // namespace

void require_rows(const Reals& array, const char* name, py::ssize_t columns) {
  require_rows(array, name, columns, std::numeric_limits<double>::max());
}

void require_points(const Reals& array, const char* name) {
  require_rows(array, name, 3, kMostCoordinate);
}

Vec3 point_of(py::handle object, const char* name) {
  if (has_mask(object))
    throw py::type_error(fmt::format(
        "{}: a masked array, whose mask would be lost; take its .compressed() or .filled()", name));
  const py::array array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(fmt::format("{}: expected three numbers", name));
  }
  if (!is_real(array.dtype().kind()))
    throw py::type_error(fmt::format("{}: expected real numbers, found dtype {}", name,
                                     py::str(array.dtype()).cast<std::string>()));
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw py::value_error(
        fmt::format("{}: expected shape (3,), found {}", name, shape_text(array)));
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
  const Vec3 point(numbers.at(0), numbers.at(1), numbers.at(2));
  if (!point.allFinite())
    throw py::value_error(fmt::format("{}: expected finite numbers, found ({}, {}, {})", name,
                                      point.x(), point.y(), point.z()));
  const double farthest = point.cwiseAbs().maxCoeff();
  if (farthest > kMostCoordinate)
    throw py::value_error(fmt::format("{}: {:.3g} is beyond {:g}, where distances overflow", name,
                                      farthest, kMostCoordinate));
  return point;
}

py::array_t<double> array_of(const Vec3& vector) {
  return py::array_t<double>(py::ssize_t{3}, vector.data());
}

NewContacts::NewContacts(std::size_t n)
    : point_(n, 3), normal_(n, 3), distance_(n), domain_(n, 2), face_(n), flags_(n), touching_(n) {}

ContactArrays<double> NewContacts::columns() {
  return {.touching = touching_.column(),
          .face = face_.column(),
          .xi = domain_.column(0),
          .eta = domain_.column(1),
          .scp = point_.vectors(),
          .normal = normal_.vectors(),
          .distance = distance_.column(),
          .flags = flags_.column()};
}

void NewContacts::set(std::size_t i, const Contact& contact) {
  point_.row(i) = contact.scp;
  normal_.row(i) = contact.normal;
  distance_.data()[i] = contact.distance;
  domain_.data()[2 * i] = contact.at.xi;
  domain_.data()[2 * i + 1] = contact.at.eta;
  face_.data()[i] = contact.at.face;
  flags_.data()[i] = contact.flags;
  touching_.data()[i] = contact.touching;
}

void NewContacts::put(py::dict& out) const {
  out["point"] = point_.array();
  out["normal"] = normal_.array();
  out["distance"] = distance_.array();
  out["face"] = face_.array();
  out["domain"] = domain_.array();
  out["touching"] = touching_.array();
}

}  // namespace gliss::python
