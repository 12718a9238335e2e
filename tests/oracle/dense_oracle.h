// The nearest point of a patch cache by dense sampling and descent, for millions of HIPs: it shares
// the evaluator with the library (judged by patch_test.cpp) and nothing of its search.
#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <limits>
#include <map>
#include <vector>

#include "tests/support/surfaces.h"

namespace gliss::test {

// A point of the surface and how far it is from the HIP.
struct Foot {
  DomainPoint at;
  Vec3 position = Vec3::Zero();
  double distance = std::numeric_limits<double>::infinity();
};

class DenseOracle {
 public:
  explicit DenseOracle(const PatchCache& cache, int resolution = 8);

  Foot nearest_sample(const Vec3& hip) const;

  // Descends from every sample whose neighbourhood may hold the nearest point.
  Foot nearest(const Vec3& hip) const;

  // To a local minimum over the start's face: Newton's method on the squared distance, its matrix
  // by differences, made positive, halved until it descends, kept to the domain and to the sides.
  Foot descend(const Vec3& hip, Foot foot) const;

 private:
  static constexpr std::size_t kMostStarts = 12;

  struct Domain {
    double apothem = 0;
    std::vector<Vec2> outward, corner;

    explicit Domain(int n) : apothem(std::cos(std::numbers::pi / n)) {
      for (int k = 0; k < n; ++k) {
        corner.push_back(oracle::domain_corner<double>(n, k));
        const double angle = (2 * k + 1) * std::numbers::pi / n;
        outward.emplace_back(std::cos(angle), std::sin(angle));
      }
    }
    // The nearest point of the domain.
    Vec2 clamp(const Vec2& X) const {
      std::size_t farthest = 0;
      for (std::size_t k = 1; k < outward.size(); ++k) {
        if (outward[k].dot(X) > outward[farthest].dot(X)) farthest = k;
      }
      const Vec2& n = outward[farthest];
      const double beyond = n.dot(X) - apothem;
      if (beyond <= 0) return X;
      const Vec2 along(-n.y(), n.x());
      const double reach = std::sqrt(1 - apothem * apothem);
      return apothem * n + std::clamp(along.dot(X), -reach, reach) * along;
    }
  };
  struct Face {
    std::uint32_t face = 0;
    std::vector<DomainPoint> at;
    std::vector<Vec3> position;
    Vec3 low, high;
    double spacing = 0;  // no point of the face is farther from a sample
    double bend = 0;     // largest curvature, by the turn of the normals between samples
  };
  struct Near {
    double distance2;  // of the face's box
    std::uint32_t face;
  };

  void add_face(std::uint32_t index);

  std::vector<Near>& faces_by_distance(const Vec3& hip) const;

  static void scan(const Face& face, const Vec3& hip, Foot& best);

  // Up to three, apart. A sample within h of a foot at distance d is at most sqrt(d^2 + h^2 (1 + d
  // bend)) from the HIP.
  void add_starts(const Face& face, const Vec3& hip, double d, std::vector<Foot>& starts) const;

  static Vec2 gradient(const SurfacePoint& p, const Vec3& hip);

  // At a point, and kApart to both sides of it along xi and along eta: at once, for that takes as
  // long as one.
  using Around = std::array<SurfacePoint, 5>;
  static constexpr double kApart = 1e-5;
  Around evaluate_around(const DomainPoint& at) const;

  static Vec2 newton_step(const Vec3& hip, const Around& around, const Vec2& g);

  bool improve(const Vec3& hip, const Vec2& X, Foot& foot) const;

  const PatchCache* cache_;
  int resolution_;
  std::map<std::uint32_t, Domain> domains_;
  std::vector<Face> faces_;
};

}  // namespace gliss::test
