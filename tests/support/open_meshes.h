// Open meshes made by formula: sheets, and the skins of solids that go on beyond their rims.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "gliss/mesh/topology.h"

namespace gliss::test {

// A grid of (along + 1) x (across + 1) vertices at position(i, j), seen from outside with i to the
// right and j upwards; normals by angle.
template <class Position>
Mesh open_grid(const std::string& name, std::uint32_t along, std::uint32_t across,
               Position position) {
  Mesh mesh;
  mesh.source = name;
  mesh.unit = 1e-3;
  for (std::uint32_t i = 0; i <= along; ++i) {
    for (std::uint32_t j = 0; j <= across; ++j) mesh.positions.push_back(position(i, j));
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return i * (across + 1) + j; };
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      for (const std::uint32_t v :
           {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)})
        mesh.corner_vertex.push_back(v);
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
    }
  }
  add_vertex_normals(mesh);
  return mesh;
}

// A sheet of 20 mm x 20 mm whose outside is +z, waved by `wave` mm.
inline double sheet_height(double wave, double x, double y) {
  return wave * std::sin(0.3 * x) * std::cos(0.25 * y);
}
inline Mesh sheet(double wave = 0) {
  return open_grid("sheet", 8, 8, [&](std::uint32_t i, std::uint32_t j) {
    const double x = 2.5 * i - 10, y = 2.5 * j - 10;
    return Vec3(x, y, sheet_height(wave, x, y));
  });
}

// The outer half of a torus of radii 30 and 10 mm, cut open along two circles and at both ends.
inline Mesh half_torus() {
  return open_grid("half torus", 12, 6, [](std::uint32_t i, std::uint32_t j) {
    const double pi = std::numbers::pi, u = pi * i / 12, v = pi * j / 6 - pi / 2;
    const double r = 30 + 10 * std::cos(v);
    return Vec3(r * std::cos(u), r * std::sin(u), 10 * std::sin(v));
  });
}

// A strip of quads a mm long over the x axis, `width` mm wide, waved: two long borders, two short.
inline Mesh open_strip(std::uint32_t quads = 8, double width = 2) {
  return open_grid("open strip", quads, 1, [&](std::uint32_t i, std::uint32_t j) {
    return Vec3(1.0 * i, (j - 0.5) * width, 0.3 * std::sin(0.7 * i));
  });
}

// Nothing but borders, and bent by its normals.
inline Mesh lone_triangle() {
  Mesh mesh;
  mesh.source = "lone triangle";
  mesh.unit = 1e-3;
  mesh.positions = {{0, 0, 0}, {10, 1, 0}, {3, 8, 1}};
  mesh.normals = {Vec3(-0.2, -0.1, 1).normalized(), Vec3(0.2, -0.1, 1).normalized(),
                  Vec3(0, 0.3, 1).normalized()};
  mesh.corner_vertex = {0, 1, 2};
  mesh.corner_normal = mesh.corner_vertex;
  mesh.face_begin.push_back(3);
  return mesh;
}

// Five of the six triangles round a point, its cone 3 mm high.
inline Mesh fan_of_five() {
  Mesh mesh;
  mesh.source = "fan of 5 of 6";
  mesh.unit = 1e-3;
  mesh.positions.push_back({0, 0, 3});
  for (int k = 0; k <= 5; ++k)
    mesh.positions.push_back(
        {10 * std::cos(k * std::numbers::pi / 3), 10 * std::sin(k * std::numbers::pi / 3), 0});
  for (std::uint32_t k = 1; k <= 5; ++k) {
    for (const std::uint32_t v : {0u, k, k + 1}) mesh.corner_vertex.push_back(v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  add_vertex_normals(mesh);
  return mesh;
}

}  // namespace gliss::test
