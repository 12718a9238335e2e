// A surface as Python holds it.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gliss/engine/engine.h"
#include "gliss/validate/validate.h"

namespace gliss::python {

namespace py = pybind11;

// Nobody changes it, so that any number of threads may ask it at once.
struct OpenSurface {
  std::string path;          // that it was read from; empty: it was made of arrays
  double crease_radius = 0;  // m, that its creases were rounded by; 0: they were not
  std::vector<Finding> findings;
  std::optional<Mesh> mesh;           // that it was built from; none: it is a cache's
  bool has_usual_creases = false;     // nobody said which they are
  std::optional<double> crease_hint;  // degrees that would part its edges plainly
  std::unique_ptr<Engine> engine;
  std::shared_ptr<const PatchCache> cache;
  std::unique_ptr<ResidentSurface> resident;
};

void bind_surface(py::module_& module);    // opening and saving
void bind_questions(py::module_& module);  // nearest, force, evaluate, tessellate
void bind_touch(py::module_& module);      // trace and hand
void bind_sweep(py::module_& module);
void bind_compare(py::module_& module);
void bind_loop(py::module_& module);

}  // namespace gliss::python
