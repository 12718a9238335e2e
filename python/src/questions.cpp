// Questions about many points at once: NumPy arrays in, NumPy arrays out, nothing copied.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "calls.h"
#include "gliss/base/stopwatch.h"
#include "gliss/build/cache_mesh.h"
#include "gliss/compare/tessellate.h"
#include "options.h"
#include "surface.h"

namespace gliss::python {
namespace {

HipArrays<double> hips_of(const Reals& points) {
  require_points(points, "points");
  return {static_cast<std::size_t>(points.shape(0)), vectors(points)};
}

void find(const OpenSurface& surface, const HipArrays<double>& hips, Method method,
          const ContactArrays<double>& out) {
  released([&] { surface.resident->nearest(hips, {&method, 1}, {}, {&out, 1}); });
}

// The arrays that Surface.nearest gives.
class NearestArrays {
 public:
  explicit NearestArrays(std::size_t n) : contacts_(n), iterations_(n) {}

  ContactArrays<double> columns() {
    ContactArrays<double> columns = contacts_.columns();
    columns.iterations = iterations_.column();
    return columns;
  }
  py::dict dict() const {
    py::dict out;
    contacts_.put(out);
    out["flags"] = contacts_.flags();
    out["iterations"] = iterations_.array();
    return out;
  }

 private:
  NewContacts contacts_;
  NewArray<int> iterations_;
};

py::dict nearest(const OpenSurface& surface, const Reals& points, const std::string& method) {
  const HipArrays<double> hips = hips_of(points);
  NearestArrays out(hips.count);
  find(surface, hips, choice("method", method, kMethodNames), out.columns());
  return out.dict();
}

// Seconds that the engine takes for nearest by itself, into memory that is there: for
// bench/python.py.
double engine_seconds(const OpenSurface& surface, const Reals& points) {
  const HipArrays<double> hips = hips_of(points);
  NearestArrays out(hips.count);
  const ContactArrays<double> columns = out.columns();
  find(surface, hips, Method::kGregory, columns);
  const Stopwatch clock;
  find(surface, hips, Method::kGregory, columns);
  return clock.seconds();
}

py::array_t<double> force(const OpenSurface& surface, const Reals& points, py::handle spring,
                          const std::string& method) {
  const double stiffness_of_it = stiffness(spring);
  const HipArrays<double> hips = hips_of(points);
  NewArray<double> push(hips.count, 3);
  find(surface, hips, choice("method", method, kMethodNames), {.push = push.vectors()});
  for (std::size_t i = 0; i < hips.count; ++i) {
    auto row = push.row(i);
    row = push_force(*surface.cache, row, stiffness_of_it);
  }
  return push.array();
}

py::dict evaluate(const OpenSurface& surface,
                  const py::array_t<std::uint32_t, py::array::c_style>& face, const Reals& domain) {
  require_rows(domain, "xi_eta", 2);
  const auto n = static_cast<std::size_t>(domain.shape(0));
  if (face.ndim() != 1 || static_cast<std::size_t>(face.shape(0)) != n)
    throw py::value_error(
        fmt::format("face: expected one for each of the {} points, found {}", n, face.size()));
  const PointArrays<double> points{n, {face.data()}, column(domain, 0), column(domain, 1)};
  for (std::size_t i = 0; i < n; ++i) {
    const DomainPoint point{points.face[i], points.xi[i], points.eta[i]};
    if (point.face >= surface.cache->mesh_face_count)
      throw py::value_error(fmt::format("face: {} in row {} is not below the number of faces, {}",
                                        point.face, i, surface.cache->mesh_face_count));
    if (!in_domain(*surface.cache, point))
      throw py::value_error(
          fmt::format("xi_eta: ({}, {}) in row {} is not in the domain of face {}, a regular "
                      "polygon of {} sides in the unit circle",
                      point.xi, point.eta, i, point.face, surface.cache->face_valence[point.face]));
  }
  NewArray<double> position(n, 3), d_xi(n, 3), d_eta(n, 3), normal(n, 3);
  const SurfaceArrays<double> into{position.vectors(), d_xi.vectors(), d_eta.vectors(),
                                   normal.vectors()};
  released([&] { surface.resident->evaluate(points, into); });
  py::dict out;
  out["point"] = position.array();
  out["d_xi"] = d_xi.array();
  out["d_eta"] = d_eta.array();
  out["normal"] = normal.array();
  return out;
}

py::dict tessellate(const OpenSurface& surface, std::int64_t cells) {
  constexpr std::int64_t kMost = 1000;
  if (cells < 1 || cells > kMost)
    throw py::value_error(fmt::format("cells: {} is not from 1 to {}", cells, kMost));
  const Mesh mesh = released([&] {
    const Mesh base = surface.mesh ? *surface.mesh : mesh_of(*surface.cache);
    const BuildBackend backend = surface.engine->build_backend();
    return gliss::tessellate(base, *surface.cache, static_cast<std::uint32_t>(cells),
                             backend.parallel, backend.poll);
  });
  const std::size_t n = mesh.positions.size();
  NewArray<double> point(n, 3), normal(n, 3);
  for (std::size_t i = 0; i < n; ++i) Eigen::Map<Vec3>(point.data() + 3 * i) = mesh.positions[i];
  for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c)
    Eigen::Map<Vec3>(normal.data() + 3 * mesh.corner_vertex[c]) =
        mesh.normals[mesh.corner_normal[c]];
  NewArray<std::uint32_t> triangles(mesh.face_count(), 3);
  std::copy(mesh.corner_vertex.begin(), mesh.corner_vertex.end(), triangles.data());
  py::dict out;
  out["point"] = point.array();
  out["normal"] = normal.array();
  out["triangles"] = triangles.array();
  return out;
}

}  // namespace

void bind_questions(py::module_& module) {
  module.def("nearest", nearest);
  module.def("engine_seconds", engine_seconds);
  module.def("force", force);
  module.def("evaluate", evaluate);
  module.def("tessellate", tessellate);
}

}  // namespace gliss::python
