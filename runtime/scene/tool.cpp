#include "gliss/scene/tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/mesh/triangulate.h"

namespace gliss {
namespace {

constexpr double kChoices = 8;       // places to choose from, for each point
constexpr int kMostPlaces = 10'000;  // on a triangle

// The vertices, and lattices of points on the faces, `step` apart.
std::vector<Vec3> places_on(const Mesh& mesh, std::span<const Vec3> triangles, double step) {
  std::vector<Vec3> places = mesh.positions;
  if (!(step > 0)) return places;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    const Vec3 a = triangles[t], ab = triangles[t + 1] - a, ac = triangles[t + 2] - a;
    const auto steps = [&](const Vec3& side) {
      return static_cast<int>(std::clamp(std::ceil(side.norm() / step), 1.0, double(kMostPlaces)));
    };
    // Two long sides of a thin triangle make many places, which lie close together one way.
    int along_ab = steps(ab), along_ac = steps(ac);
    int& fewer = along_ab < along_ac ? along_ab : along_ac;
    fewer = std::min(fewer, std::max(1, kMostPlaces / std::max(along_ab, along_ac)));
    for (int i = 0; i <= along_ab; ++i) {
      for (int j = 0; j <= along_ac; ++j) {
        const double u = double(i) / along_ab, v = double(j) / along_ac;
        if (u + v <= 1) places.push_back(a + u * ab + v * ac);
      }
    }
  }
  return places;
}

double area_of(std::span<const Vec3> triangles) {
  double area = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 3)
    area += 0.5 * (triangles[t + 1] - triangles[t]).cross(triangles[t + 2] - triangles[t]).norm();
  return area;
}

}  // namespace

std::vector<Vec3> spread_points(const Mesh& mesh, std::size_t count, const Poll& poll) {
  const PlainArithmetic plain;
  std::vector<Vec3> points;
  if (mesh.positions.empty()) return points;
  const std::vector<Vec3> triangles = triangles_of(mesh);
  const double step = std::sqrt(area_of(triangles) / (kChoices * static_cast<double>(count)));
  const std::vector<Vec3> places = places_on(mesh, triangles, step);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : mesh.positions) box.extend(p);
  // Squared, of each place to the nearest point so far.
  std::vector<double> away(places.size(), std::numeric_limits<double>::infinity());
  Vec3 last = box.center();
  while (points.size() < count) {
    poll();
    const bool is_first = points.empty();
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < away.size(); ++i) {
      const double to_last = (places[i] - last).squaredNorm();
      away[i] = is_first ? to_last : std::min(away[i], to_last);
      if (away[i] > away[farthest]) farthest = i;
    }
    if (!is_first && !(away[farthest] > 0)) break;  // no other place is left
    last = places[farthest];
    points.push_back(mesh.unit * last);
    if (is_first) std::fill(away.begin(), away.end(), std::numeric_limits<double>::infinity());
  }
  return points;
}

}  // namespace gliss
