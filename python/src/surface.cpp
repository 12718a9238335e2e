#include "surface.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <numbers>

#include "arrays.h"
#include "calls.h"
#include "errors.h"
#include "gliss/base/units.h"
#include "gliss/build/build_cache.h"
#include "gliss/build/cache_mesh.h"
#include "gliss/engine/engine_choice.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/rounding.h"
#include "gliss/mesh/topology.h"
#include "gliss/results/lengths.h"
#include "options.h"

namespace gliss::python {
namespace {

using Indices = py::array_t<std::uint32_t, py::array::c_style>;

// How a surface is read and built.
struct Opening {
  LoadOptions load;
  bool has_unit = false;
  double crease_radius = 0;  // m
  std::optional<Precision> precision;
  std::optional<Level> level;
  std::optional<Construction> construction;
  EngineChoice engine;
};

double unit_of(py::handle value) {
  const double unit = py::isinstance<py::str>(value)
                          ? parse_unit(value.cast<std::string>())
                          : quantity(value, "unit", parse_unit, "a unit such as 'mm', or metres");
  if (!(unit >= kLeastUnit && unit <= kMostUnit))
    throw py::value_error(fmt::format("unit: {} m is not from 1e-15 to 1e15 m", unit));
  return unit;
}

// The length that borders are welded within, in the mesh's unit; below 0: never.
double weld_of(py::handle value, double unit) {
  if (value.is_none()) return 0;
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? 0 : -1;
  return length(value, "weld") / unit;
}

template <class Value, std::size_t count>
std::optional<Value> perhaps(const py::dict& options, const char* name,
                             const Named<Value> (&names)[count]) {
  if (options[name].is_none()) return std::nullopt;
  return choice(name, text(options, name), names);
}

Opening opening_of(const py::dict& options) {
  Opening opening;
  opening.has_unit = !options["unit"].is_none();
  if (opening.has_unit) opening.load.unit = unit_of(options["unit"]);
  opening.load.strict = yes_or_no(options, "strict");
  opening.load.keep_non_manifold = yes_or_no(options, "keep_non_manifold");
  opening.load.weld = weld_of(options["weld"], opening.load.unit);
  opening.load.normals = choice("normals", text(options, "normals"), kNormalNames);
  opening.load.orient = choice("orient", text(options, "orient"), kOrientNames);
  opening.load.flip = yes_or_no(options, "flip");
  if (!options["crease"].is_none()) opening.load.creases = parse_creases(text(options, "crease"));
  if (!options["crease_radius"].is_none()) {
    opening.crease_radius = length(options["crease_radius"], "crease_radius");
  }
  opening.load.poll = poll;
  opening.precision = perhaps(options, "precision", kPrecisionNames);
  opening.construction = perhaps(options, "construction", kConstructionNames);
  if (!options["level"].is_none()) {
    const auto name = text(options, "level");
    opening.level = find_level(name);
    if (!opening.level) throw py::value_error("level: " + no_level(name));
  }
  const std::int64_t threads = whole_number(options, "threads");
  if (threads < 0 || threads > 4096)
    throw py::value_error(fmt::format("threads: {} is not from 0 to 4096", threads));
  opening.engine.threads = static_cast<int>(threads);
  opening.engine.backend = choice("backend", text(options, "backend"), kBackendNames);
  opening.engine.device = text(options, "opencl_device");
  if (opening.engine.names_device_in_vain())
    throw py::value_error("opencl_device: only the backends opencl and auto have one");
  return opening;
}

std::shared_ptr<OpenSurface> begin(const Opening& opening) {
  const auto surface = std::make_shared<OpenSurface>();
  surface->engine = make_engine(opening.engine, poll, nullptr);
  surface->crease_radius = opening.crease_radius;
  return surface;
}

// `make` gives the mesh, with its creases marked. `progress` is told of faces.
template <class Make>
void build(OpenSurface& surface, const Opening& opening, const Progress& progress, Make make) {
  try {
    surface.mesh = make(&surface.findings);
    const CreaseRules& rules = opening.load.creases;
    surface.has_usual_creases = rules.are_usual();
    if (rules.are_usual() && surface.mesh->sharp.empty()) {
      const auto angle = plain_crease_angle(*surface.mesh, build_topology(*surface.mesh));
      if (angle) surface.crease_hint = *angle * 180 / std::numbers::pi;
    }
    if (opening.crease_radius > 0) {
      if (surface.mesh->sharp.empty() && (rules.none || rules.are_usual()))
        throw py::value_error(
            "crease_radius: no edge is a crease; add which edges it rounds, as crease='auto' or "
            "crease='40deg'");
      round_creases(*surface.mesh, opening.crease_radius, poll);
    }
    BuildOptions options;
    options.precision = opening.precision.value_or(Precision::kDouble);
    options.level = chosen_level(opening.level, opening.construction);
    BuildBackend backend = surface.engine->build_backend();
    const std::size_t all = surface.mesh->face_count();
    backend.progress = [&](std::size_t faces) { progress.reach(faces, all); };
    surface.cache =
        std::make_shared<PatchCache>(build_cache(*surface.mesh, options, nullptr, backend));
  } catch (const MeshError& error) {
    throw FoundMeshError(error, std::move(surface.findings));
  }
}

void read(OpenSurface& surface, const Opening& opening) {
  if (!opening.load.creases.are_usual())
    throw py::value_error(fmt::format(
        "{}: a cache has the creases that it was baked with; crease is for meshes", surface.path));
  surface.cache = std::make_shared<PatchCache>(
      load_cache_of(surface.path, {opening.precision, opening.level, opening.construction}, poll));
  if (opening.has_unit && surface.cache->unit != opening.load.unit)
    throw py::value_error(fmt::format("{}: the unit of this cache is {}, not {}", surface.path,
                                      unit_name(surface.cache->unit),
                                      unit_name(opening.load.unit)));
}

std::shared_ptr<OpenSurface> load(const std::string& path, const py::dict& options) {
  check_file(path);
  const Opening opening = opening_of(options);
  const Progress progress(options["progress"]);
  return released([&] {
    auto surface = begin(opening);
    surface->path = path;
    if (is_meant_as_cache(path)) {
      read(*surface, opening);
    } else {
      build(*surface, opening, progress, [&](std::vector<Finding>* findings) {
        return load_mesh(path, opening.load, findings);
      });
    }
    surface->resident = surface->engine->reside(*surface->cache);
    return surface;
  });
}

// A mesh of arrays that are not checked but for what a Mesh must not be without.
Mesh mesh_of_arrays(const Reals& vertices, const Indices& offsets, const Indices& corners,
                    double unit) {
  if (vertices.ndim() != 2 || vertices.shape(1) != 3)
    throw py::value_error("vertices: expected shape (n, 3)");
  if (offsets.ndim() != 1 || corners.ndim() != 1)
    throw py::value_error("faces: expected offsets and corners of one dimension");
  Mesh mesh;
  mesh.unit = unit;
  mesh.source = "faces";
  const StridedVectors<const double> from = vectors(vertices);
  mesh.positions.resize(static_cast<std::size_t>(vertices.shape(0)));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.positions[i] = Vec3(from.x[i], from.y[i], from.z[i]);
  mesh.face_begin.assign(offsets.data(), offsets.data() + offsets.size());
  mesh.corner_vertex.assign(corners.data(), corners.data() + corners.size());
  if (mesh.face_begin.empty() || mesh.face_begin.front() != 0 ||
      mesh.face_begin.back() != mesh.corner_vertex.size() ||
      !std::is_sorted(mesh.face_begin.begin(), mesh.face_begin.end()))
    throw py::value_error(
        fmt::format("faces: expected offsets that go from 0 up to the number of corners, {}",
                    mesh.corner_vertex.size()));
  return mesh;
}

std::shared_ptr<OpenSurface> from_arrays(const Reals& vertices, const Indices& offsets,
                                         const Indices& corners, const py::dict& options) {
  const Opening opening = opening_of(options);
  const Progress progress(options["progress"]);
  Mesh mesh = mesh_of_arrays(vertices, offsets, corners, opening.load.unit);
  return released([&] {
    auto surface = begin(opening);
    build(*surface, opening, progress, [&](std::vector<Finding>* findings) {
      take_mesh(mesh, opening.load, findings);
      return std::move(mesh);
    });
    surface->resident = surface->engine->reside(*surface->cache);
    return surface;
  });
}

py::array_t<double> bounds_of(const OpenSurface& surface) {
  const Box box = surface.cache->bounds();
  NewArray<double> bounds(2, 3);
  std::copy_n(box.low.data(), 3, bounds.data());
  std::copy_n(box.high.data(), 3, bounds.data() + 3);
  return bounds.array();
}

// Vertices (n, 3), offsets and corners of the faces.
py::tuple mesh_arrays(const OpenSurface& surface) {
  const Mesh mesh = surface.mesh ? *surface.mesh : mesh_of(*surface.cache);
  NewArray<double> vertices(mesh.positions.size(), 3);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    std::copy_n(mesh.positions[v].data(), 3, vertices.data() + 3 * v);
  NewArray<std::uint32_t> offsets(mesh.face_begin.size()), corners(mesh.corner_vertex.size());
  std::copy(mesh.face_begin.begin(), mesh.face_begin.end(), offsets.data());
  std::copy(mesh.corner_vertex.begin(), mesh.corner_vertex.end(), corners.data());
  return py::make_tuple(vertices.array(), offsets.array(), corners.array());
}

py::tuple tuple_of(const Departure& d) { return py::make_tuple(d.distance, d.room, d.face); }

}  // namespace

void bind_surface(py::module_& module) {
  py::class_<OpenSurface, std::shared_ptr<OpenSurface>>(module, "OpenSurface", made_by_functions())
      .def_property_readonly("unit", [](const OpenSurface& s) { return s.cache->unit; })
      .def_property_readonly("faces", [](const OpenSurface& s) { return s.cache->mesh_face_count; })
      .def_property_readonly("patches", [](const OpenSurface& s) { return s.cache->patch_count(); })
      .def_property_readonly("level",
                             [](const OpenSurface& s) { return level_name(s.cache->level); })
      .def_property_readonly(
          "construction",
          [](const OpenSurface& s) { return construction_name(s.cache->level.construction); })
      .def_property_readonly(
          "precision", [](const OpenSurface& s) { return precision_name(s.cache->precision()); })
      .def_property_readonly("nbytes", [](const OpenSurface& s) { return s.cache->bytes(); })
      .def_property_readonly("bounds", bounds_of)
      .def_property_readonly("departure",
                             [](const OpenSurface& s) { return tuple_of(s.cache->departure); })
      .def_property_readonly("tightest",
                             [](const OpenSurface& s) { return tuple_of(s.cache->tightest); })
      .def_property_readonly(
          "faithful", [](const OpenSurface& s) { return s.cache->tightest.share() <= kFaithful; })
      .def_property_readonly("backend", [](const OpenSurface& s) { return s.engine->name(); })
      .def_property_readonly("threads", [](const OpenSurface& s) { return s.engine->threads(); })
      .def_property_readonly("path", [](const OpenSurface& s) { return s.path; })
      .def("mesh", mesh_arrays)
      .def_property_readonly(
          "creases",
          [](const OpenSurface& s) {
            return s.mesh ? std::count(s.mesh->sharp.begin(), s.mesh->sharp.end(), 1) / 2 : 0;
          })
      .def_readonly("has_usual_creases", &OpenSurface::has_usual_creases)
      .def_readonly("crease_hint", &OpenSurface::crease_hint)
      .def_property_readonly("findings", [](const OpenSurface& s) { return list_of(s.findings); })
      .def("save", [](const OpenSurface& s, const std::string& path) {
        released([&] { save_cache(*s.cache, path, poll); });
      });
  module.def("load", load);
  module.def("from_arrays", from_arrays);
}

}  // namespace gliss::python
