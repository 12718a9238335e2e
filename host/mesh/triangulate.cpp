#include "gliss/mesh/triangulate.h"

#include <algorithm>
#include <numeric>

#include "gliss/mesh/topology.h"

namespace gliss {
namespace {

// Twice the area of a triangle seen along the normal.
double area(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  return normal.dot((b - a).cross(c - a));
}

// A corner whose triangle with its neighbours is turned outward and holds no reflex corner.
bool is_ear(std::span<const Vec3> p, const std::vector<std::uint32_t>& ring, std::size_t at,
            const Vec3& normal) {
  const std::size_t n = ring.size();
  const std::uint32_t i = ring[(at + n - 1) % n], j = ring[at], k = ring[(at + 1) % n];
  if (area(p[i], p[j], p[k], normal) <= 0) return false;
  for (std::size_t r = 0; r < n; ++r) {
    const std::uint32_t v = ring[r];
    if (v == i || v == j || v == k) continue;
    if (area(p[ring[(r + n - 1) % n]], p[v], p[ring[(r + 1) % n]], normal) > 0) continue;
    if (area(p[i], p[j], p[v], normal) >= 0 && area(p[j], p[k], p[v], normal) >= 0 &&
        area(p[k], p[i], p[v], normal) >= 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

void triangulate(std::span<const Vec3> corners, const Vec3& normal,
                 std::vector<std::uint32_t>& triangles) {
  if (corners.size() == 3) {
    triangles.insert(triangles.end(), {0, 1, 2});
    return;
  }
  thread_local std::vector<std::uint32_t> ring;
  ring.resize(corners.size());
  std::iota(ring.begin(), ring.end(), 0u);
  std::size_t at = 0;
  // A quad is cut along its shorter diagonal where both are possible.
  if (ring.size() == 4 &&
      (corners[0] - corners[2]).squaredNorm() <= (corners[1] - corners[3]).squaredNorm()) {
    at = 1;
  }
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    std::size_t tries = 0;
    while (tries < n && !is_ear(corners, ring, (at + tries) % n, normal)) ++tries;
    // No ear: the polygon crosses itself; any corner will do.
    const std::size_t ear = (at + tries) % n;
    triangles.insert(triangles.end(), {ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    // Every second corner, round and round: triangles stay fat where a fan's would be slivers.
    at = (ear + 1) % ring.size();
  }
  triangles.insert(triangles.end(), ring.begin(), ring.end());
}

std::vector<Vec3> triangles_of(const Mesh& mesh) {
  std::vector<Vec3> triangles, corners;
  std::vector<std::uint32_t> cut;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    corners.clear(), cut.clear();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c)
      corners.push_back(mesh.positions[mesh.corner_vertex[c]]);
    triangulate(corners, newell_normal(mesh, face), cut);
    for (const std::uint32_t corner : cut) triangles.push_back(corners[corner]);
  }
  return triangles;
}

}  // namespace gliss
