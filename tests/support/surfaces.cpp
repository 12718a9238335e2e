#include "tests/support/surfaces.h"

namespace gliss::test {

std::string shared_path(const std::string& name) { return std::string(test::kShared) + "/" + name; }

Mesh mesh_of(const Polygon& polygon) {
  Mesh mesh;
  mesh.positions = polygon.positions;
  mesh.normals = polygon.normals;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  mesh.face_begin.push_back(n);
  for (std::uint32_t k = 0; k < n; ++k) mesh.corner_vertex.push_back(k);
  mesh.corner_normal = mesh.corner_vertex;
  return mesh;
}

Polygon polygon_of(const Mesh& mesh, std::size_t face) {
  Polygon polygon;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
    polygon.positions.push_back(mesh.positions[mesh.corner_vertex[c]]);
    polygon.normals.push_back(mesh.normals[mesh.corner_normal[c]]);
  }
  return polygon;
}

std::vector<SurfacePoint> along_side(const PatchCache& cache, const Mesh& mesh,
                                     const Topology& topology, std::uint32_t side,
                                     const std::vector<double>& t) {
  const std::uint32_t face = topology.side_face[side];
  const int n = static_cast<int>(mesh.valence(face));
  const int k = static_cast<int>(side - mesh.face_begin[face]);
  std::vector<DomainPoint> at;
  for (const double x : t) {
    const Vec2 X = oracle::on_side(n, k, x);
    at.push_back({face, X.x(), X.y()});
  }
  std::vector<SurfacePoint> points(t.size());
  evaluate(cache, at, points);
  return points;
}

PatchKind kind_of(const PatchCache& cache, std::uint32_t face) {
  return cache.kind[cache.first_patch(face)];
}

Mesh with_normals(Mesh mesh) {
  add_vertex_normals(mesh);
  return mesh;
}

Mesh load_shared(const std::string& name) {
  return with_normals(load_mesh(shared_path(name + ".obj"), {.creases = {.none = true}}));
}

double size_of(const Mesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

PatchCache unlimited_cache(Mesh mesh, const BuildOptions& options, BuildReport* report) {
  add_vertex_normals(mesh, normal_weights(options.level.construction));
  return build_cache(mesh, build_topology(mesh), options, report);
}
PatchCache cache_of(const Mesh& mesh, Precision precision, bool tame, BuildReport* report,
                    Construction construction) {
  BuildOptions options;
  options.precision = precision;
  options.level.construction = construction;
  options.tame = tame;
  return unlimited_cache(mesh, options, report);
}
PatchCache paper_cache_of(const Mesh& mesh, Precision precision, bool tame, BuildReport* report) {
  return cache_of(mesh, precision, tame, report, Construction::kPaper);
}

SurfacePoint at(const PatchCache& cache, std::uint32_t face, const Vec2& X) {
  return evaluate(cache, {face, X.x(), X.y()});
}

void break_patch(PatchCache& cache, std::uint32_t face) {
  auto& surface = std::get<Surface<double>>(cache.surface);
  const std::size_t begin = 3 * std::size_t{surface.control_begin[cache.first_patch(face)]};
  surface.control[begin] = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace gliss::test
