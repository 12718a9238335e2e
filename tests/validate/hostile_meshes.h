// Meshes that are accepted and cost more than others: poles that many faces share, parts at one
// place, parts without number, parts that all meet. Sizes are near 1.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "tests/oracle/union_oracle.h"

namespace gliss::test {

// A double cone: n thin triangles round each of two poles.
inline Mesh fan(std::uint32_t n) {
  Mesh mesh;
  mesh.positions = {{0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    mesh.positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    const std::uint32_t a = 2 + i, b = 2 + (i + 1) % n;
    for (const std::uint32_t v : {0u, a, b, 1u, b, a}) mesh.corner_vertex.push_back(v);
    mesh.face_begin.push_back(6 * i + 3);
    mesh.face_begin.push_back(6 * i + 6);
  }
  return mesh;
}

inline Mesh octahedron(const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity(),
                       const Vec3& centre = Vec3::Zero()) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) mesh.positions.push_back(centre + sign * axes.col(axis));
  }
  mesh.corner_vertex = {4, 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 5, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3};
  for (std::uint32_t f = 1; f <= 8; ++f) mesh.face_begin.push_back(3 * f);
  return mesh;
}

inline Mesh coincident_shells(std::size_t n) { return joined(std::vector<Mesh>(n, octahedron())); }

// In rows, apart from each other.
inline Mesh many_parts(std::size_t n) {
  std::vector<Mesh> parts;
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(static_cast<double>(n))));
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 at(static_cast<double>(i % side), static_cast<double>(i / side % side),
                  static_cast<double>(i / side / side));
    parts.push_back(octahedron(Eigen::Matrix3d::Identity(), 3 * at));
  }
  return joined(parts);
}

// All of which meet.
inline Mesh crowd(std::size_t n) {
  std::vector<Mesh> parts;
  oracle::Rng rng(5);
  const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < n; ++i)
    parts.push_back(octahedron(axes, 0.5 * oracle::random_unit(rng)));
  return joined(parts);
}

// A thousand times as long as thick, all through one point.
inline Mesh needles(std::size_t n) {
  std::vector<Mesh> parts;
  oracle::Rng rng(5);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 along = oracle::random_unit(rng), aside = along.unitOrthogonal();
    Eigen::Matrix3d axes;
    axes << 1e-3 * aside, 1e-3 * along.cross(aside), along;
    parts.push_back(octahedron(axes));
  }
  return joined(parts);
}

}  // namespace gliss::test
