// Keyword arguments of Python as the library's options.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gliss/query/effects.h"
#include "gliss/query/query.h"
#include "gliss/surface/names.h"

namespace gliss::python {

namespace py = pybind11;

// A quantity: a finite number in SI, or text with a unit as the program reads it; `parse` null: a
// number alone. Throws TypeError, and UnitError, which is ValueError. `what` is "a stiffness in
// N/m, or text such as '0.5N/mm'".
double quantity(py::handle value, const char* name, double (*parse)(std::string_view),
                const char* what);
// The usual ones; all throw ValueError for what is out of range.
double length(py::handle value, const char* name);  // m, above 0
double stiffness(py::handle value);                 // N/m, above 0
double settle(py::handle value, const char* name);  // s, 0 to 1
double tick(py::handle value);                      // s, above 0, to 1
std::vector<double> depths(py::handle list);        // m, above 0; one, or a list of them
FrictionOptions friction(py::handle value, py::handle settle_time);  // a number, or two
// magnet: (force, range); texture: (relief, height, period) or with a vector behind.
EffectOptions effects(py::handle damping, py::handle viscosity, py::handle magnet,
                      py::handle texture);

// A member of a dict of options. Throws TypeError: "threads: expected a whole number".
std::string text(const py::dict& options, const char* name);
bool yes_or_no(const py::dict& options, const char* name);
std::int64_t whole_number(const py::dict& options, const char* name);

template <class Value, std::size_t count>
Value choice(const char* name, const std::string& wanted, const Named<Value> (&names)[count]) {
  if (const auto value = find_named(names, wanted)) return *value;
  throw py::value_error(std::string(name) + ": '" + wanted + "' is not one of " + listed(names));
}

// The options of Surface.trace and Surface.hand.
struct TouchOptions {
  double stiffness = 500;  // N/m
  QueryOptions query{};
  EffectOptions effects{};
};
TouchOptions touch_options(const py::dict& options);

}  // namespace gliss::python
