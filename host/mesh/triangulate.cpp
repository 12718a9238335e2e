#include "gliss/mesh/triangulate.h"

#include <algorithm>
#include <array>
#include <numeric>

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

// Corners of a face that lie on one line, as far as files say: the height of their triangle over
// its longest side is less.
constexpr double kSliver = 1e-4;

// The height of a triangle over its longest side, as seen along the normal, and that side's number.
struct Thinness {
  double height, longest;
  std::size_t side;  // from corner `side` to the next

  bool is_sliver() const { return height < kSliver * longest; }
};
Thinness thinness_of(std::span<const Vec3> p, const std::uint32_t* t, const Vec3& normal) {
  Thinness r{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const double length = (p[t[(k + 1) % 3]] - p[t[k]]).norm();
    if (length > r.longest) r = {0, length, k};
  }
  if (r.longest > 0)
    r.height = area(p[t[0]], p[t[1]], p[t[2]], normal) / (r.longest * normal.norm());
  return r;
}

// Gives the corner in the middle of each sliver to the triangle across its longest side, in whose
// stead there are two: patches of slivers spread over their plane. A sliver at a side of the
// polygon stays.
void flip_slivers(std::span<const Vec3> p, const Vec3& normal, std::span<std::uint32_t> triangles) {
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
      const Thinness thin = thinness_of(p, &triangles[t], normal);
      if (!thin.is_sliver()) continue;
      const std::uint32_t from = triangles[t + thin.side], to = triangles[t + (thin.side + 1) % 3],
                          middle = triangles[t + (thin.side + 2) % 3];
      for (std::size_t other = 0; other < triangles.size(); other += 3) {
        std::size_t k = 0;
        while (k < 3 && !(triangles[other + k] == to && triangles[other + (k + 1) % 3] == from))
          ++k;
        if (k == 3) continue;
        const std::uint32_t apex = triangles[other + (k + 2) % 3];
        const std::array<std::uint32_t, 3> one{middle, from, apex}, two{middle, apex, to};
        const double least =
            std::min(thin.height, thinness_of(p, &triangles[other], normal).height);
        if (std::min(thinness_of(p, one.data(), normal).height,
                     thinness_of(p, two.data(), normal).height) > least) {
          std::copy(one.begin(), one.end(), &triangles[t]);
          std::copy(two.begin(), two.end(), &triangles[other]);
          goes_on = true;
        }
        break;
      }
    }
  }
}

}  // namespace

void triangulate(std::span<const Vec3> corners, const Vec3& normal,
                 std::vector<std::uint32_t>& triangles) {
  if (corners.size() == 3) {
    triangles.insert(triangles.end(), {0, 1, 2});
    return;
  }
  const std::size_t first = triangles.size();
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
  flip_slivers(corners, normal, std::span(triangles).subspan(first));
}

void append_triangles(const Mesh& mesh, std::size_t face, std::vector<Vec3>& triangles) {
  const auto place = [&](std::uint32_t c) { return mesh.positions[mesh.corner_vertex[c]]; };
  append_triangles(mesh, face, place, triangles);
}

std::vector<Vec3> triangles_of(const Mesh& mesh) {
  std::vector<Vec3> triangles;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    append_triangles(mesh, face, triangles);
  return triangles;
}

}  // namespace gliss
