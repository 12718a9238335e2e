#include "shapes.h"

#include <cmath>
#include <utility>

#include "gliss/mesh/topology.h"

namespace gliss::rivals {
namespace {

Mesh mesh_of(std::vector<Vec3> positions, const std::vector<std::vector<std::uint32_t>>& faces) {
  Mesh mesh;
  mesh.unit = 1e-3;
  mesh.positions = std::move(positions);
  for (const std::vector<std::uint32_t>& face : faces) {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), face.begin(), face.end());
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  return mesh;
}

// Puts the vertices on the exact surface, with its normals.
Generated on_surface(Mesh mesh, std::shared_ptr<const ExactSurface> exact) {
  mesh.normals.clear();
  for (Vec3& position : mesh.positions) {
    const ExactSurface::Point at = exact->nearest(position);
    position = at.position;
    mesh.normals.push_back(at.normal);
  }
  mesh.corner_normal = mesh.corner_vertex;
  return {std::move(mesh), std::move(exact)};
}

// A vertex for each face, and a face for each vertex.
Mesh dual(const Mesh& mesh) {
  const Topology topology = build_topology(mesh);
  std::vector<Vec3> middles;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
      sum += mesh.positions[mesh.corner_vertex[c]];
    middles.emplace_back(sum / mesh.valence(face));
  }
  std::vector<std::vector<std::uint32_t>> faces;
  for (const std::uint32_t first : topology.vertex_side) {
    faces.emplace_back();
    std::uint32_t side = first;
    do {
      faces.back().push_back(topology.side_face[side]);
      side = next_around(mesh, topology, side);
    } while (side != first);
  }
  return mesh_of(std::move(middles), faces);
}

Mesh cut_quads(const Mesh& quads) {
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::size_t c = 0; c < quads.corner_vertex.size(); c += 4) {
    const std::uint32_t* v = &quads.corner_vertex[c];
    faces.push_back({v[0], v[1], v[2]});
    faces.push_back({v[0], v[2], v[3]});
  }
  return mesh_of(quads.positions, faces);
}

Mesh scaled(Mesh mesh, const Vec3& by) {
  for (Vec3& position : mesh.positions) position = position.cwiseProduct(by);
  return mesh;
}

int whole(double x) { return static_cast<int>(std::lround(x)); }

// A sphere, stretched to half axes; or a ring of quads, `square` times as long as it is round.
Shape ball(const std::string& name, const Vec3& half, std::shared_ptr<const ExactSurface> exact) {
  const auto icosphere = [half](int faces) {
    const Generated sphere = goldberg(whole(std::sqrt(faces / 20.0)), 1);
    return scaled(on_surface(dual(sphere.mesh), sphere.exact).mesh, half);
  };
  const auto cubes = [half](int faces) {
    const Mesh mesh = cube(whole(std::sqrt(faces / 6.0)), 2).mesh;
    return scaled(on_surface(mesh, goldberg(1, 1).exact).mesh, half);
  };
  return {name, std::move(exact), icosphere, cubes};
}
template <class Make>
Shape ring(const std::string& name, double square, Make make) {
  const auto quads = [=](int faces) {
    const int around = whole(std::sqrt(faces / square));
    return make(whole(1.0 * faces / around), around).mesh;
  };
  const auto triangles = [=](int faces) { return cut_quads(quads(faces / 2)); };
  return {name, make(3, 3).exact, triangles, quads};
}

}  // namespace

std::vector<Shape> shapes() {
  return {ball("sphere", Vec3::Constant(10), goldberg(1, 10).exact),
          ball("ellipsoid 20:12:8", {20, 12, 8}, ellipsoid(1, 40, 24, 16).exact),
          ring("torus 3:1", 3.2, [](int along, int around) { return torus(along, around); }),
          ring("knot", 4.5, [](int along, int around) { return torus_knot(along, around); })};
}

Generated made(const Shape& shape, Kind kind, int faces, std::uint64_t seed) {
  if (kind == Kind::kQuads) return on_surface(shape.quads(faces), shape.exact);
  if (kind == Kind::kPolygons) return on_surface(dual(shape.triangles(2 * faces)), shape.exact);
  Generated triangles = on_surface(shape.triangles(faces), shape.exact);
  return kind == Kind::kRandomTriangles ? irregular(std::move(triangles), seed) : triangles;
}

}  // namespace gliss::rivals
