#include "gliss/walk/random_places.h"

#include <algorithm>

#include "gliss/mesh/topology.h"
#include "gliss/mesh/triangulate.h"

namespace gliss {

Random::Random(std::uint64_t seed, std::uint64_t walker) {
  std::seed_seq seeds{seed, seed >> 32, walker, walker >> 32};
  engine_.seed(seeds);
}

double Random::normal() {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += uniform();
  return sum;
}

double Random::size(double least, double octaves) {
  const double at = octaves * uniform(), whole = std::floor(at);
  return std::ldexp(least * (1 + at - whole), static_cast<int>(whole));
}

Vec3 Random::vector() {
  const double z = normal(), y = normal(), x = normal();
  return {x, y, z};
}

Places::Places(const Mesh& mesh) : corner_(triangles_of(mesh)) {
  for (std::size_t t = 0; t < corner_.size(); t += 3) {
    const Vec3* p = &corner_[t];
    const double area = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    until_.push_back((until_.empty() ? 0 : until_.back()) + area);
  }
}

Vec3 Places::choose(Random& random) const {
  const double area = random.uniform() * until_.back();
  const auto at = std::upper_bound(until_.begin(), until_.end() - 1, area) - until_.begin();
  const Vec3* p = &corner_[3 * static_cast<std::size_t>(at)];
  double u = random.uniform(), v = random.uniform();
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
}

BoxMeasure::BoxMeasure(const Mesh& mesh) {
  Vec3 low = mesh.positions.front(), high = low;
  for (const Vec3& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  middle = (low + high) / 2;
  diagonal = (high - low).norm();
}

Vec3 turned(const Vec3& direction, const Vec3& normal, double angle) {
  const Vec3 tangent = across(normal, direction).normalized();
  return (tangent + angle * normal.cross(tangent)).normalized();
}

}  // namespace gliss
