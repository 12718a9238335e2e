// gliss._gliss, the compiled part of the package: what python/gliss/__init__.py wraps.
#include <pybind11/pybind11.h>

#include "calls.h"
#include "errors.h"
#include "surface.h"

PYBIND11_MODULE(_gliss, module) {
  pybind11::options options;
  options.disable_function_signatures();
  module.attr("__version__") = GLISS_VERSION;
  gliss::python::keep_calls_whole();
  gliss::python::bind_errors(module);
  gliss::python::bind_surface(module);
  gliss::python::bind_questions(module);
  gliss::python::bind_touch(module);
  gliss::python::bind_sweep(module);
  gliss::python::bind_compare(module);
  gliss::python::bind_loop(module);
}
