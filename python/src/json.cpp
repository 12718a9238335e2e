#include "json.h"

namespace gliss::python {

pybind11::object python_of(const Json& json) {
  const auto text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return pybind11::module_::import("json").attr("loads")(text);
}

}  // namespace gliss::python
