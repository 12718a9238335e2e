// Meshes with sharp edges whose surfaces are known.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
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

// Two polygons, as seen from above, and quads between them.
inline Mesh prism_between(const std::vector<Vec3>& top, const std::vector<Vec3>& bottom) {
  Mesh mesh;
  mesh.source = "prism";
  mesh.positions = top;
  mesh.positions.insert(mesh.positions.end(), bottom.begin(), bottom.end());
  const auto n = static_cast<std::uint32_t>(top.size());
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

// A star pulled up to a prism, whose two ends are not flat.
inline Mesh star_prism(oracle::Rng& rng, std::uint32_t points) {
  std::vector<double> radius(2 * points, 10);
  for (std::uint32_t k = 0; k < radius.size(); k += 2) radius[k] = oracle::uniform(rng, 3, 8);
  const auto end = [&](double z) {
    std::vector<Vec3> ring;
    for (std::uint32_t k = 0; k < radius.size(); ++k) {
      const double angle = std::numbers::pi * k / points;
      ring.emplace_back(radius[k] * std::cos(angle), radius[k] * std::sin(angle),
                        z + oracle::uniform(rng, -3, 3));
    }
    return ring;
  };
  const std::vector<Vec3> top = end(10);
  return prism_between(top, end(-10));
}

// A plate of 40 x 20 x 4 with round corners: its top and its bottom have 28 sides, most of them
// short.
inline Mesh rounded_plate() {
  std::vector<Vec3> top, bottom;
  for (int k = 0; k < 28; ++k) {
    const double angle = std::numbers::pi / 2 * (k / 7 + k % 7 / 6.0);
    const double x = k / 7 == 1 || k / 7 == 2 ? -16 : 16, y = k / 7 < 2 ? 6 : -6;
    top.emplace_back(x + 4 * std::cos(angle), y + 4 * std::sin(angle), 2);
    bottom.push_back(top.back() - Vec3(0, 0, 4));
  }
  return prism_between(top, bottom);
}

// A comb of 40 x 20 x `thick`, turned at random, as files have it: with ten digits.
inline Mesh comb(oracle::Rng& rng, std::uint32_t teeth, double thick) {
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), oracle::random_unit(rng));
  const double wide = 40.0 / (2 * teeth - 1);
  std::vector<Vec3> top, bottom;
  const auto add = [&](double x, double y) {
    for (const auto& [ring, z] : {std::pair{&top, thick}, std::pair{&bottom, 0.0}})
      ring->push_back((turn * Vec3(x, y, z) * 1e8).array().round() / 1e8);
  };
  add(40, 20), add(0, 20);
  for (std::uint32_t k = 0; k < teeth; ++k) {
    add(2 * k * wide, 0), add((2 * k + 1) * wide, 0);
    if (k + 1 < teeth) add((2 * k + 1) * wide, 15), add((2 * k + 2) * wide, 15);
  }
  return prism_between(top, bottom);
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

// An L of `cells` squares along each of its shorter edges, of length 1.
inline Mesh fine_l_solid(int cells) {
  std::vector<std::array<int, 3>> filled;
  for (int i = 0; i < 2 * cells; ++i)
    for (int j = 0; j < 2 * cells; ++j)
      for (int k = 0; k < cells; ++k)
        if (i < cells || j < cells) filled.push_back({i, j, k});
  Mesh mesh = boxes(filled);
  for (Vec3& p : mesh.positions) p /= cells;
  return mesh;
}

// A plate of 60 x 60 x 10 with a hole of radius 8 along z, from whose rims long thin triangles go
// to the four corners: the more the rims are turned, by up to 0.55 rad, the more of them graze.
inline Mesh drilled_plate(std::uint32_t around, double turned) {
  Mesh mesh;
  mesh.source = "drilled plate";
  const std::uint32_t half = 4 + around;
  for (const double z : {0.0, 10.0}) {
    for (const auto& [x, y] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
      mesh.positions.emplace_back(30.0 * x, 30.0 * y, z);
    for (std::uint32_t k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around + turned;
      mesh.positions.emplace_back(8 * std::cos(angle), 8 * std::sin(angle), z);
    }
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.corner_vertex.insert(mesh.corner_vertex.end(), {a, b, c});
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  };
  const auto rim = [&](std::uint32_t k) { return 4 + k % around; };
  const auto add_both = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    add(c, b, a), add(half + a, half + b, half + c);
  };
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    const std::uint32_t after = (corner + 1) % 4, last = (corner + 1) * around / 4;
    for (std::uint32_t k = corner * around / 4; k < last; ++k) add_both(corner, rim(k + 1), rim(k));
    add_both(corner, after, rim(last));
    add(corner, after, half + after), add(corner, half + after, half + corner);
  }
  for (std::uint32_t k = 0; k < around; ++k)
    add(rim(k + 1), rim(k), half + rim(k)), add(rim(k + 1), half + rim(k), half + rim(k + 1));
  return mesh;
}

// The mesh with each vertex that no crease is at moved within its faces, by up to `most`: their
// corners move in their planes where these are parallel to the axes.
inline Mesh shaken(Mesh mesh, double most, std::uint32_t seed) {
  oracle::Rng rng(seed);
  const Topology topology = build_topology(mesh);
  mark_creases(mesh, topology, {.angle = 40 * kDegree});
  std::vector<char> stays(mesh.positions.size(), 0);
  for (std::uint32_t side = 0; side < mesh.sharp.size(); ++side)
    if (mesh.is_crease(side)) stays[mesh.corner_vertex[side]] = 1;
  const std::vector<Vec3> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < stays.size(); ++v) {
    if (stays[v] != 0) continue;
    const Vec3 by = oracle::uniform(rng, 0, most) * oracle::random_unit(rng);
    mesh.positions[v] += across(normals[v], by);
  }
  mesh.sharp.clear();
  return mesh;
}

inline Mesh with_creases(Mesh mesh, const CreaseRules& rules = {.angle = 40 * kDegree}) {
  mark_creases(mesh, build_topology(mesh), rules);
  return mesh;
}

}  // namespace gliss::test
