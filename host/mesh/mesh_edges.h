// Edges of a mesh whose faces may still be turned either way. Private to host/.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

struct Edge {
  std::uint32_t lower, upper;            // its two vertices
  std::span<const std::uint32_t> sides;  // ascending; valid during the visit only
};

inline std::uint32_t next_corner(const Mesh& mesh, std::uint32_t face, std::uint32_t corner) {
  return corner + 1 == mesh.face_begin[face + 1] ? mesh.face_begin[face] : corner + 1;
}

inline std::uint32_t prev_corner(const Mesh& mesh, std::uint32_t face, std::uint32_t corner) {
  return (corner == mesh.face_begin[face] ? mesh.face_begin[face + 1] : corner) - 1;
}

// [side], its face
GLISS_EXPORT std::vector<std::uint32_t> side_faces(const Mesh& mesh);

// [side], the other side of its edge; kNone where the edge has any other number of sides than two
GLISS_EXPORT std::vector<std::uint32_t> pair_sides(const Mesh& mesh,
                                                   const std::vector<std::uint32_t>& side_face);

// Calls visit(const Edge&) once an edge, ordered by lower, then upper vertex: a counting sort by
// the lower vertex, then each vertex sorts its few edges, so time is linear and memory 4 bytes a
// side and vertex.
template <class Visit>
void for_each_edge(const Mesh& mesh, const std::vector<std::uint32_t>& side_face, Visit visit) {
  const auto ends = [&](std::uint32_t side) {
    return std::minmax(
        {mesh.corner_vertex[side], mesh.corner_vertex[next_corner(mesh, side_face[side], side)]});
  };
  const auto side_count = static_cast<std::uint32_t>(side_face.size());
  std::vector<std::uint32_t> begin(mesh.positions.size() + 2, 0);  // [vertex + 1] while filling
  for (std::uint32_t side = 0; side < side_count; ++side) ++begin[ends(side).first + 2];
  for (std::size_t v = 2; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<std::uint32_t> by_lower(side_count);
  for (std::uint32_t side = 0; side < side_count; ++side) {
    by_lower[begin[ends(side).first + 1]++] = side;
  }

  std::vector<std::pair<std::uint32_t, std::uint32_t>> star;  // upper vertex, side
  std::vector<std::uint32_t> sides;
  for (std::uint32_t lower = 0; lower < mesh.positions.size(); ++lower) {
    star.clear();
    for (std::uint32_t i = begin[lower]; i < begin[lower + 1]; ++i) {
      star.emplace_back(ends(by_lower[i]).second, by_lower[i]);
    }
    std::sort(star.begin(), star.end());
    for (std::size_t i = 0; i < star.size();) {
      const std::uint32_t upper = star[i].first;
      sides.clear();
      for (; i < star.size() && star[i].first == upper; ++i) sides.push_back(star[i].second);
      visit(Edge{lower, upper, sides});
    }
  }
}

// Sets that grow together (union by index, path halving).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) {
    for (std::size_t i = 0; i < size; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // False where both were of one set already.
  bool unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace gliss
