#include "errors.h"

#include <cerrno>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "gliss/base/units.h"
#include "gliss/engine/opencl.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/open_file.h"
#include "gliss/results/finding_json.h"
#include "gliss/scene/scene.h"
#include "gliss/thread/realtime.h"
#include "json.h"

namespace gliss::python {
namespace {

py::handle mesh_error, cache_error, scene_error, device_error;

py::handle make_error(py::module_& module, const char* name, PyObject* base, const char* doc,
                      const py::dict& members = {}) {
  const std::string full = std::string("gliss.") + name;
  const py::handle made = PyErr_NewExceptionWithDoc(full.c_str(), doc, base, members.ptr());
  if (!made) throw py::error_already_set();
  module.add_object(name, made);
  return made;
}

// An instance with a member set.
void raise(py::handle type, const char* what, const char* member, const py::object& value) {
  const py::object error = type(what);
  error.attr(member) = value;
  PyErr_SetObject(type.ptr(), error.ptr());
}

void raise_os(int number, const std::string& what) {
  PyErr_SetObject(PyExc_OSError, py::make_tuple(number, what).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const FoundMeshError& error) {
    raise(mesh_error, error.what(), "findings", py::tuple(list_of(error.findings)));
  } catch (const MeshError& error) {
    PyErr_SetString(mesh_error.ptr(), error.what());
  } catch (const CacheError& error) {
    raise(cache_error, error.what(), "stale", py::bool_(error.stale));
  } catch (const SceneError& error) {
    PyErr_SetString(scene_error.ptr(), error.what());
  } catch (const DeviceError& error) {
    PyErr_SetString(device_error.ptr(), error.what());
  } catch (const LoopError& error) {
    PyErr_SetString(device_error.ptr(), error.what());
  } catch (const UnitError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const NoFileError& error) {
    raise_os(EINVAL, error.what());
  } catch (const std::system_error& error) {
    raise_os(error.code().value(), error.what());
  }
}

}  // namespace

py::list list_of(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back(json_of(finding));
  return python_of(list);
}

void check_file(const std::string& path) {
  const auto status = std::filesystem::status(path);
  if (!exists(status)) {
    raise_os(ENOENT, "there is no file '" + path + "'");
  } else if (is_directory(status)) {
    raise_os(EISDIR, "'" + path + "' is a folder");
  } else {
    return;
  }
  throw py::error_already_set();
}

void bind_errors(py::module_& module) {
  py::dict found, stale;
  found["findings"] = py::tuple();
  stale["stale"] = false;
  mesh_error = make_error(module, "MeshError", PyExc_ValueError,
                          "A mesh that cannot be used. The text names file, line, face or edge.\n\n"
                          "findings: all that its checks found, dicts as Surface.findings has.",
                          found);
  cache_error = make_error(module, "CacheError", PyExc_ValueError,
                           "A cache that cannot be read. The text names the file and the section.\n"
                           "\nstale: it is sound, but of another mesh, version or level.",
                           stale);
  scene_error = make_error(module, "SceneError", PyExc_ValueError,
                           "A scene that cannot be used. The text names file, line and key.");
  device_error = make_error(module, "DeviceError", PyExc_RuntimeError,
                            "A haptic or an OpenCL device that is not there or that failed.");
  py::register_exception_translator(translate);
}

}  // namespace gliss::python
