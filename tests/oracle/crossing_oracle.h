// Counts how often a HIP has crossed a surface, by its way through fine triangles alone: no tracker
// and no nearest point has a say.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "gliss/mesh/mesh.h"

namespace gliss::test {

// Triangles in the cells of a grid. Shared between threads once made.
class CrossingOracle {
 public:
  // `triangles`: such as tessellate (host/compare/tessellate.h) makes.
  explicit CrossingOracle(const Mesh& triangles) {
    Vec3 low = triangles.positions.front(), high = low;
    for (const Vec3& p : triangles.positions) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    double sides = 0;
    for (std::size_t t = 0; t < triangles.face_count(); ++t) {
      corners_.push_back(
          {corner(triangles, t, 0), corner(triangles, t, 1), corner(triangles, t, 2)});
      sides += (corners_[t][1] - corners_[t][0]).norm();
    }
    cell_ = std::max(2 * sides / static_cast<double>(corners_.size()), (high - low).norm() / 500);
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      const auto& [a, b, c] = corners_[t];
      for_each_cell(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), [&](std::uint64_t cell) {
        in_cell_[cell].push_back(static_cast<std::uint32_t>(t));
      });
    }
  }

  // Crossings inward less those outward on the straight way between two points.
  int crossings(const Vec3& from, const Vec3& to) const {
    std::vector<std::uint32_t> near;
    for_each_cell(from.cwiseMin(to), from.cwiseMax(to), [&](std::uint64_t cell) {
      const auto found = in_cell_.find(cell);
      if (found != in_cell_.end())
        near.insert(near.end(), found->second.begin(), found->second.end());
    });
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    int sum = 0;
    for (const std::uint32_t t : near) sum += crossing(corners_[t], from, to);
    return sum;
  }

 private:
  using Triangle = std::array<Vec3, 3>;

  static Vec3 corner(const Mesh& mesh, std::size_t face, std::uint32_t k) {
    return mesh.positions[mesh.corner_vertex[mesh.face_begin[face] + k]];
  }
  static double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
  }
  // 1: from the front to the back, -1: the other way. A point on the plane is in front, whichever
  // end of a way it is: so a path of many ways counts each crossing once.
  static int crossing(const Triangle& t, const Vec3& from, const Vec3& to) {
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const bool front = normal.dot(from - t[0]) >= 0;
    if (front == (normal.dot(to - t[0]) >= 0)) return 0;
    const bool u = volume(from, to, t[0], t[1]) > 0, v = volume(from, to, t[1], t[2]) > 0,
               w = volume(from, to, t[2], t[0]) > 0;
    return u == v && v == w ? (front ? 1 : -1) : 0;
  }
  template <class Visit>
  void for_each_cell(const Vec3& low, const Vec3& high, Visit visit) const {
    std::array<std::int64_t, 3> a{}, b{};
    for (int i = 0; i < 3; ++i) {
      a[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor(low[i] / cell_));
      b[static_cast<std::size_t>(i)] = static_cast<std::int64_t>(std::floor(high[i] / cell_));
    }
    const auto part = [](std::int64_t x) { return static_cast<std::uint64_t>(x) & 0x1FFFFF; };
    for (std::int64_t x = a[0]; x <= b[0]; ++x)
      for (std::int64_t y = a[1]; y <= b[1]; ++y)
        for (std::int64_t z = a[2]; z <= b[2]; ++z) visit(part(x) << 42 | part(y) << 21 | part(z));
  }

  std::vector<Triangle> corners_;
  double cell_ = 1;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> in_cell_;
};

}  // namespace gliss::test
