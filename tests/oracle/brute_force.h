// The nearest point of a whole mesh by brute force: of its oracle patches, or of its triangles.
#pragma once

#include <array>

#include "tests/support/surfaces.h"

namespace gliss::test {

struct NearestPoint {
  Vec3 position;
  double distance = 0;
};

// Nearest points of a mesh that has normals: samples every patch, then searches each whose best
// sample is no farther than the best of all by more than the samples of either can be wrong.
class PatchBruteForce {
 public:
  explicit PatchBruteForce(const Mesh& mesh, int resolution = 12) {
    for (std::size_t face = 0; face < mesh.face_count(); ++face) {
      Patch patch;
      patch.polygon = polygon_of(mesh, face);
      const int n = patch.polygon.size();
      for (const Vec2& X : oracle::sample_domain<double>(n, resolution)) {
        patch.samples.push_back(oracle::evaluate(patch.polygon, X.x(), X.y()).G);
      }
      patch.spacing = 2 * oracle::size_of(patch.polygon) / resolution;
      patches_.push_back(std::move(patch));
    }
  }

  NearestPoint nearest(const Vec3& hip) const {
    std::vector<double> sampled;
    double least = std::numeric_limits<double>::infinity();
    for (const Patch& patch : patches_) {
      double best = std::numeric_limits<double>::infinity();
      for (const Vec3& p : patch.samples) best = std::min(best, (p - hip).squaredNorm());
      sampled.push_back(std::sqrt(best));
      least = std::min(least, sampled.back());
    }
    NearestPoint result;
    result.distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < patches_.size(); ++i) {
      if (!(lower_bound(sampled[i], patches_[i].spacing) <= least)) continue;
      const auto found = oracle::nearest(patches_[i].polygon, hip, 6, 2);
      if (found.distance < result.distance) result = {found.G, found.distance};
    }
    return result;
  }

 private:
  struct Patch {
    Polygon polygon;
    std::vector<Vec3> samples;
    double spacing = 0;
  };

  // Bounds the distance of a surface that has a point at `distance` and none of whose points is
  // farther than `spacing` from a sample. A foot on the surface is at right angles to what is near
  // it.
  static double lower_bound(double distance, double spacing) {
    const double nearest = distance - spacing;
    return nearest <= spacing ? nearest
                              : std::sqrt(distance * distance - spacing * spacing) - spacing / 8;
  }

  std::vector<Patch> patches_;
};

using Triangle = std::array<Vec3, 3>;

// Ericson, Real-Time Collision Detection (2005), 5.1.5: by the region of the triangle's plane.
inline Vec3 nearest_on_triangle(const Triangle& triangle, const Vec3& p) {
  const auto& [a, b, c] = triangle;
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

// Fans: right for faces that are planar and convex.
inline std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const auto corner = [&](std::uint32_t k) {
      return mesh.positions[mesh.corner_vertex[mesh.face_begin[face] + k]];
    };
    for (std::uint32_t k = 2; k < mesh.valence(face); ++k) {
      triangles.push_back({corner(0), corner(k - 1), corner(k)});
    }
  }
  return triangles;
}

inline NearestPoint nearest_by_brute_force(const std::vector<Triangle>& triangles, const Vec3& p) {
  NearestPoint best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : triangles) {
    const Vec3 q = nearest_on_triangle(triangle, p);
    if ((q - p).norm() < best.distance) best = {q, (q - p).norm()};
  }
  return best;
}

// A point of the box of a mesh, grown about its middle.
inline Vec3 random_in_box(oracle::Rng& rng, const Mesh& mesh, double grown) {
  Vec3 low = mesh.positions.front(), high = low, p;
  for (const Vec3& q : mesh.positions) low = low.cwiseMin(q), high = high.cwiseMax(q);
  for (int i = 0; i < 3; ++i) {
    const double half = (high[i] - low[i]) / 2 * grown;
    p[i] = (low[i] + high[i]) / 2 + oracle::uniform(rng, -half, half);
  }
  return p;
}

}  // namespace gliss::test
