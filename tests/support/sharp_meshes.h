// Meshes with sharp edges whose surfaces are known.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "gliss/generate/generate.h"
#include "gliss/mesh/creases.h"
#include "gliss/mesh/topology.h"
#include "tests/support/points.h"

namespace gliss::test {

constexpr double kDegree = std::numbers::pi / 180;

// The surface of unit cubes, as their square faces.
inline Mesh boxes(const std::vector<std::array<int, 3>>& cells) {
  using Cell = std::array<int, 3>;
  std::map<Cell, char> filled;
  for (const Cell& c : cells) filled[c] = 1;
  std::map<Cell, std::uint32_t> numbers;
  Mesh mesh;
  mesh.source = "boxes";
  const auto vertex = [&](const Cell& at) {
    const auto [known, is_new] =
        numbers.try_emplace(at, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) mesh.positions.emplace_back(at[0], at[1], at[2]);
    return known->second;
  };
  for (const Cell& cell : cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int up : {0, 1}) {
        Cell beside = cell;
        beside[axis] += up ? 1 : -1;
        if (filled.contains(beside)) continue;
        Cell corner = cell;
        corner[axis] += up;
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::array<Cell, 4> around{corner, corner, corner, corner};
        ++around[1][u], ++around[2][u], ++around[2][v], ++around[3][v];
        for (int i = 0; i < 4; ++i)
          mesh.corner_vertex.push_back(vertex(around[static_cast<std::size_t>(up ? i : 3 - i)]));
        mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
      }
    }
  }
  return mesh;
}

inline Mesh without_normals(Mesh mesh) {
  mesh.normals.clear();
  mesh.corner_normal.clear();
  return mesh;
}

inline Mesh cube() { return boxes({{0, 0, 0}}); }
// An L: its concave edge is x = y = 1.
inline Mesh l_solid() { return boxes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}); }
// Three cubes about one: a corner where three concave edges meet, and others of all kinds.
inline Mesh corner_solid() {
  return boxes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}});
}

// A square with a border, z = -sqrt(x^2 + s^2) with s = max(0, -y): for y > 0 a roof whose ridge is
// x = 0, for y < 0 a cone. Its ridge ends in y = 0.
inline Mesh ridge(int half = 4) {
  Mesh mesh;
  mesh.source = "ridge";
  const auto count = static_cast<std::uint32_t>(2 * half + 1);
  for (int j = -half; j <= half; ++j) {
    for (int i = -half; i <= half; ++i) {
      const double x = 1.0 * i / half, y = 1.0 * j / half, s = std::max(0.0, -y);
      mesh.positions.emplace_back(x, y, -std::sqrt(x * x + s * s));
    }
  }
  for (std::uint32_t j = 0; j + 1 < count; ++j) {
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
      const std::uint32_t a = j * count + i;
      mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, a + 1, a + 1 + count, a + count});
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
    }
  }
  return mesh;
}

// A star pulled up to a prism, whose two ends are not flat.
inline Mesh star_prism(oracle::Rng& rng, std::uint32_t points) {
  Mesh mesh;
  mesh.source = "star prism";
  const std::uint32_t n = 2 * points;
  std::vector<double> radius(n, 10);
  for (std::uint32_t k = 0; k < n; k += 2) radius[k] = oracle::uniform(rng, 3, 8);
  for (const double end : {10.0, -10.0}) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n, lift = oracle::uniform(rng, -3, 3);
      mesh.positions.emplace_back(radius[k] * std::cos(angle), radius[k] * std::sin(angle),
                                  end + lift);
    }
  }
  const auto end_face = [&] {
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  };
  for (std::uint32_t k = 0; k < n; ++k) mesh.corner_vertex.push_back(k);
  end_face();
  for (std::uint32_t k = n; k-- > 0;) mesh.corner_vertex.push_back(n + k);
  end_face();
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {k, n + k, n + next, next});
    end_face();
  }
  return mesh;
}

// Each face cut into triangles from its first corner.
inline Mesh in_triangles(const Mesh& mesh) {
  Mesh cut;
  cut.source = mesh.source + " in triangles";
  cut.positions = mesh.positions;
  cut.unit = mesh.unit;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    for (std::uint32_t c = mesh.face_begin[f] + 1; c + 1 < mesh.face_begin[f + 1]; ++c) {
      cut.corner_vertex.insert(cut.corner_vertex.end(),
                               {mesh.corner_vertex[mesh.face_begin[f]], mesh.corner_vertex[c],
                                mesh.corner_vertex[c + 1]});
      cut.face_begin.push_back(static_cast<std::uint32_t>(cut.corner_vertex.size()));
    }
  }
  return cut;
}

inline Mesh with_creases(Mesh mesh, const CreaseRules& rules = {.angle = 40 * kDegree}) {
  mark_creases(mesh, build_topology(mesh), rules);
  return mesh;
}

}  // namespace gliss::test
