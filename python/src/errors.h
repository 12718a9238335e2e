// Errors of the library as Python's: MeshError, CacheError, SceneError and DeviceError of the
// module, ValueError for slips, OSError for files. Their text is the program's one line.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "gliss/mesh/mesh.h"
#include "gliss/validate/validate.h"

namespace gliss::python {

namespace py = pybind11;

// A MeshError with all that was found until then.
struct FoundMeshError : MeshError {
  FoundMeshError(const MeshError& error, std::vector<Finding> findings)
      : MeshError(error), findings(std::move(findings)) {}
  std::vector<Finding> findings;
};

// Dicts with the keys of gliss check --json.
py::list list_of(const std::vector<Finding>& findings);

// Throws FileNotFoundError, IsADirectoryError where there is no file to read.
void check_file(const std::string& path);

void bind_errors(py::module_& module);

}  // namespace gliss::python
