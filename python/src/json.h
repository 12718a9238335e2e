// JSON of the program as Python's objects.
#pragma once

#include <pybind11/pybind11.h>

#include "gliss/results/json.h"

namespace gliss::python {

pybind11::object python_of(const Json& json);

}  // namespace gliss::python
