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
  explicit DenseOracle(const PatchCache& cache, int resolution = 8)
      : cache_(&cache), resolution_(resolution) {
    for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face)
      if (cache.face_patch[face] != kNone) add_face(face);
  }

  Foot nearest_sample(const Vec3& hip) const {
    std::vector<Near>& near = faces_by_distance(hip);
    Foot best;
    for (const Near& face : near) {
      if (face.distance2 > best.distance * best.distance) break;
      scan(faces_[face.face], hip, best);
    }
    return best;
  }

  // Descends from every sample whose neighbourhood may hold the nearest point.
  Foot nearest(const Vec3& hip) const {
    Foot best = nearest_sample(hip);
    std::vector<Foot> starts;
    const double d = best.distance;
    for (const Near& near : faces_by_distance(hip)) {
      if (near.distance2 > d * d) break;
      add_starts(faces_[near.face], hip, d, starts);
    }
    std::sort(starts.begin(), starts.end(),
              [](const Foot& a, const Foot& b) { return a.distance < b.distance; });
    if (starts.size() > kMostStarts) starts.resize(kMostStarts);
    std::vector<Vec3> found;
    for (const Foot& start : starts) {
      const double h = faces_[start.at.face].spacing;
      const bool known = std::any_of(found.begin(), found.end(), [&](const Vec3& p) {
        return (p - start.position).norm() < 0.5 * h;
      });
      if (known) continue;
      const Foot foot = descend(hip, start);
      found.push_back(foot.position);
      if (foot.distance < best.distance) best = foot;
    }
    return best;
  }

  // To a local minimum over the start's face: Newton's method on the squared distance, its matrix
  // by differences, made positive, halved until it descends, kept to the domain and to the sides.
  Foot descend(const Vec3& hip, Foot foot) const {
    const Domain& domain = domains_.at(cache_->face_valence[foot.at.face]);
    for (int i = 0; i < 40; ++i) {
      const Vec2 X(foot.at.xi, foot.at.eta);
      const Around around = evaluate_around(foot.at);
      const SurfacePoint& here = around[0];
      const Vec2 g = gradient(here, hip);
      Vec2 step = newton_step(hip, around, g);
      for (const Vec2& outward : domain.outward) {  // along a side that it leans on
        if (domain.apothem - outward.dot(X) > 1e-12 || outward.dot(step) <= 0) continue;
        const Vec2 along(-outward.y(), outward.x());
        step = along.dot(step) * along;
      }
      bool moved = false;
      const double length = step.norm();
      if (length > 2.0 / resolution_) step *= 2.0 / resolution_ / length;
      const Vec2 steepest = -g / (here.d_xi.squaredNorm() + here.d_eta.squaredNorm());
      for (const Vec2& way : {step, steepest}) {
        double part = 1;
        for (int halvings = 0; halvings < 12 && !moved; ++halvings, part /= 2)
          moved = improve(hip, domain.clamp(X + part * way), foot);
        if (moved) break;
      }
      if (!moved || length < 1e-7) break;
    }
    return foot;
  }

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

  void add_face(std::uint32_t index) {
    const int n = static_cast<int>(cache_->face_valence[index]);
    domains_.try_emplace(static_cast<std::uint32_t>(n), n);
    Face face;
    face.face = index;
    for (const Vec2& X : oracle::sample_domain<double>(n, resolution_))
      face.at.push_back({index, X.x(), X.y()});
    std::vector<SurfacePoint> points(face.at.size());
    evaluate(*cache_, face.at, points);
    face.low = face.high = points[0].position;
    double stretch = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SurfacePoint& p = points[i];
      face.position.push_back(p.position);
      face.low = face.low.cwiseMin(p.position), face.high = face.high.cwiseMax(p.position);
      stretch = std::max(stretch, std::sqrt(p.d_xi.squaredNorm() + p.d_eta.squaredNorm()));
      if (i == 0) continue;
      const double apart = (p.position - points[i - 1].position).norm();
      if (apart > 0)
        face.bend =
            std::max(face.bend, oracle::angle<double>(p.normal, points[i - 1].normal) / apart);
    }
    face.spacing = 0.6 * stretch / resolution_;
    const Vec3 margin = Vec3::Constant(0.5 * face.bend * face.spacing * face.spacing);
    face.low -= margin, face.high += margin;
    faces_.push_back(std::move(face));
  }

  std::vector<Near>& faces_by_distance(const Vec3& hip) const {
    thread_local std::vector<Near> near;
    near.clear();
    double least = std::numeric_limits<double>::infinity();
    for (const Face& face : faces_) least = std::min(least, (face.position[0] - hip).squaredNorm());
    for (std::uint32_t i = 0; i < faces_.size(); ++i) {
      const Face& face = faces_[i];
      const Vec3 beyond = (face.low - hip).cwiseMax(hip - face.high).cwiseMax(0.0);
      if (beyond.squaredNorm() <= least) near.push_back({beyond.squaredNorm(), i});
    }
    std::sort(near.begin(), near.end(),
              [](const Near& a, const Near& b) { return a.distance2 < b.distance2; });
    return near;
  }

  static void scan(const Face& face, const Vec3& hip, Foot& best) {
    std::size_t nearest = face.at.size();
    double least = best.distance * best.distance;
    for (std::size_t i = 0; i < face.position.size(); ++i) {
      const double d2 = (face.position[i] - hip).squaredNorm();
      if (d2 < least) least = d2, nearest = i;
    }
    if (nearest < face.at.size())
      best = {face.at[nearest], face.position[nearest], std::sqrt(least)};
  }

  // Up to three, apart. A sample within h of a foot at distance d is at most sqrt(d^2 + h^2 (1 + d
  // bend)) from the HIP.
  void add_starts(const Face& face, const Vec3& hip, double d, std::vector<Foot>& starts) const {
    const double h = face.spacing, most = d * d + h * h * (1 + d * face.bend);
    thread_local std::vector<std::pair<double, std::uint32_t>> near;
    near.clear();
    for (std::uint32_t i = 0; i < face.position.size(); ++i) {
      const double d2 = (face.position[i] - hip).squaredNorm();
      if (d2 <= most) near.emplace_back(d2, i);
    }
    for (int taken = 0; taken < 3 && !near.empty(); ++taken) {
      const auto [d2, i] = *std::min_element(near.begin(), near.end());
      starts.push_back({face.at[i], face.position[i], std::sqrt(d2)});
      std::erase_if(near, [&, i = i](const auto& other) {
        const DomainPoint &a = face.at[i], &b = face.at[other.second];
        return std::hypot(a.xi - b.xi, a.eta - b.eta) < 2.5 / resolution_;
      });
    }
  }

  static Vec2 gradient(const SurfacePoint& p, const Vec3& hip) {
    const Vec3 r = p.position - hip;
    return {r.dot(p.d_xi), r.dot(p.d_eta)};
  }

  // At a point, and kApart to both sides of it along xi and along eta: at once, for that takes as
  // long as one.
  using Around = std::array<SurfacePoint, 5>;
  static constexpr double kApart = 1e-5;
  Around evaluate_around(const DomainPoint& at) const {
    const Vec2 X = (1 - 4 * kApart) * Vec2(at.xi, at.eta);  // off the sides
    std::array<DomainPoint, 5> points{at};
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec2 there = X + (i % 2 ? kApart : -kApart) * Vec2::Unit(static_cast<int>(i / 2));
      points[i + 1] = {at.face, there.x(), there.y()};
    }
    Around around;
    evaluate(*cache_, points, around);
    return around;
  }

  static Vec2 newton_step(const Vec3& hip, const Around& around, const Vec2& g) {
    const SurfacePoint& here = around[0];
    Eigen::Matrix2d H;
    for (int axis = 0; axis < 2; ++axis) {
      const auto before = static_cast<std::size_t>(1 + 2 * axis);
      H.col(axis) =
          (gradient(around[before + 1], hip) - gradient(around[before], hip)) / (2 * kApart);
    }
    H(0, 1) = H(1, 0) = 0.5 * (H(0, 1) + H(1, 0));
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(H);
    const double least = 1e-9 * (here.d_xi.squaredNorm() + here.d_eta.squaredNorm());
    const Vec2 size = eigen.eigenvalues().cwiseAbs().cwiseMax(least);
    const Vec2 turned = eigen.eigenvectors().transpose() * g;
    return -(eigen.eigenvectors() * turned.cwiseQuotient(size));
  }

  bool improve(const Vec3& hip, const Vec2& X, Foot& foot) const {
    const DomainPoint at{foot.at.face, X.x(), X.y()};
    const Vec3 position = evaluate(*cache_, at).position;
    const double distance = (position - hip).norm();
    if (!(distance < foot.distance)) return false;
    foot = {at, position, distance};
    return true;
  }

  const PatchCache* cache_;
  int resolution_;
  std::map<std::uint32_t, Domain> domains_;
  std::vector<Face> faces_;
};

}  // namespace gliss::test
