// Goldberg sphere, and ellipsoids that it is stretched to: the dual of an icosahedron whose faces
// are cut into frequency^2 triangles.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "gliss/base/message.h"
#include "gliss/generate/generate.h"
#include "gliss/generate/generate_exact.h"
#include "gliss/generate/generate_parts.h"
#include "gliss/mesh/topology.h"

namespace gliss {
namespace {

// Three golden rectangles, at right angles to one another.
const std::array<Vec3, 12>& corners() {
  constexpr double g = std::numbers::phi;
  static const std::array<Vec3, 12> kCorners{Vec3{-1, g, 0},  Vec3{1, g, 0},   Vec3{-1, -g, 0},
                                             Vec3{1, -g, 0},  Vec3{0, -1, g},  Vec3{0, 1, g},
                                             Vec3{0, -1, -g}, Vec3{0, 1, -g},  Vec3{g, 0, -1},
                                             Vec3{g, 0, 1},   Vec3{-g, 0, -1}, Vec3{-g, 0, 1}};
  return kCorners;
}

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::array<Triangle, 20> kTriangles{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

class Icosphere {
 public:
  explicit Icosphere(int frequency) : frequency_(frequency) {
    for (const Triangle& triangle : kTriangles) cut(triangle);
  }
  const Mesh& mesh() const { return mesh_; }

 private:
  void cut(const Triangle& triangle) {
    for (int i = 0; i < frequency_; ++i) {
      for (int j = 0; i + j < frequency_; ++j) {
        const std::uint32_t b = vertex(triangle, i + 1, j), c = vertex(triangle, i, j + 1);
        add_face(mesh_, {vertex(triangle, i, j), b, c});
        if (i + j + 1 < frequency_) add_face(mesh_, {b, vertex(triangle, i + 1, j + 1), c});
      }
    }
  }

  // The vertex i steps towards the second corner and j towards the third; triangles share it by
  // its weights, which are whole numbers.
  std::uint32_t vertex(const Triangle& triangle, int i, int j) {
    const std::array<int, 3> weight{frequency_ - i - j, i, j};
    Key key;
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      if (weight[k] > 0) key[k] = {triangle[k], weight[k]};
      sum += weight[k] * corners()[triangle[k]];
    }
    std::sort(key.begin(), key.end());
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [known, is_new] = vertices_.try_emplace(key, next);
    if (is_new) mesh_.positions.push_back(sum.normalized());
    return known->second;
  }

  using Key = std::array<std::pair<std::uint32_t, int>, 3>;  // corner and weight, if any
  int frequency_;
  Mesh mesh_;
  std::map<Key, std::uint32_t> vertices_;
};

}  // namespace

Generated goldberg(int frequency, double radius) {
  require(frequency >= 1 && radius > 0, "goldberg: needs a frequency and a radius");
  const Icosphere icosphere(frequency);
  const Mesh& triangles = icosphere.mesh();
  const Topology topology = build_topology(triangles);

  Mesh mesh = make_mesh(detail::message("goldberg(", frequency, ")"));
  for (std::size_t face = 0; face < triangles.face_count(); ++face) {
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t c = triangles.face_begin[face]; c < triangles.face_begin[face + 1]; ++c) {
      sum += triangles.positions[triangles.corner_vertex[c]];
    }
    mesh.normals.push_back(sum.normalized());
    mesh.positions.push_back(radius * mesh.normals.back());
  }
  for (const std::uint32_t first : topology.vertex_side) {
    std::uint32_t side = first;
    do {
      mesh.corner_vertex.push_back(topology.side_face[side]);
      side = next_around(triangles, topology, side);
    } while (side != first);
    add_face(mesh, {});
  }
  share_normals(mesh);
  return {std::move(mesh), std::make_shared<Sphere>(radius)};
}

Generated nested_balls(const std::vector<double>& radii, int frequency) {
  Mesh mesh = make_mesh("nested_balls");
  for (const double radius : radii) {
    const Mesh ball = goldberg(frequency, std::abs(radius)).mesh;
    const auto before = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), ball.positions.begin(), ball.positions.end());
    for (std::size_t face = 0; face < ball.face_count(); ++face) {
      std::vector<std::uint32_t> corners(ball.corner_vertex.begin() + ball.face_begin[face],
                                         ball.corner_vertex.begin() + ball.face_begin[face + 1]);
      if (radius < 0) std::reverse(corners.begin(), corners.end());
      for (const std::uint32_t vertex : corners) mesh.corner_vertex.push_back(before + vertex);
      add_face(mesh, {});
    }
  }
  return {std::move(mesh), nullptr};
}

Generated ellipsoid(int frequency, double length, double width, double height) {
  require(length > 0 && width > 0 && height > 0, "ellipsoid: needs a size");
  const Vec3 half = Vec3(length, width, height) / 2;
  const auto exact = std::make_shared<Ellipsoid>(half);
  Mesh mesh = goldberg(frequency, 1).mesh;
  mesh.source = detail::message("ellipsoid(", frequency, ")");
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.positions[v] = mesh.positions[v].cwiseProduct(half);
    mesh.normals[v] = exact->normal_at(mesh.positions[v]);
  }
  return {std::move(mesh), exact};
}

}  // namespace gliss
