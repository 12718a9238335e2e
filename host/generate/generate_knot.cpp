// Tube round the (2, 3) torus knot: rings at equal steps of arc length, in a frame that turns about
// the curve as little as closing allows, with the rest spread evenly over the parameter.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "gliss/base/message.h"
#include "gliss/generate/generate.h"
#include "gliss/generate/generate_exact.h"
#include "gliss/generate/generate_parts.h"

namespace gliss {
namespace {

class KnotCurve {
 public:
  struct Jet {
    Vec3 position, first, second;  // derivatives by t
  };

  KnotCurve(double R, double r) : R_(R), r_(r), sums_(kPanels + 1) {
    for (std::size_t i = 0; i < kPanels; ++i) {
      const Sums panel = integrate(panel_start(i), panel_start(i + 1));
      sums_[i + 1] = {sums_[i].length + panel.length, sums_[i].turn + panel.turn};
    }
    const double turns = sums_.back().turn / kTurn;
    closing_ = std::round(turns) - turns;
  }

  double length() const { return sums_.back().length; }

  Jet jet(double t) const {
    const double c2 = std::cos(2 * t), s2 = std::sin(2 * t);
    const double c3 = std::cos(3 * t), s3 = std::sin(3 * t);
    const double w = R_ + r_ * c3, w1 = -3 * r_ * s3, w2 = -9 * r_ * c3;
    return {{w * c2, w * s2, r_ * s3},
            {w1 * c2 - 2 * w * s2, w1 * s2 + 2 * w * c2, 3 * r_ * c3},
            {w2 * c2 - 4 * w1 * s2 - 4 * w * c2, w2 * s2 + 4 * w1 * c2 - 4 * w * s2, -9 * r_ * s3}};
  }

  // Normal of the torus that the knot winds on, hence of the knot too.
  static Vec3 torus_normal(double t) {
    return {std::cos(3 * t) * std::cos(2 * t), std::cos(3 * t) * std::sin(2 * t), std::sin(3 * t)};
  }

  double parameter_at(double length) const {
    const std::size_t i = panel_of(length);
    const double start = panel_start(i);
    double t = start;
    for (int step = 0; step < 6; ++step) {  // Newton; the speed varies little within a panel
      t -= (sums_[i].length + integrate(start, t).length - length) / jet(t).first.norm();
    }
    return t;
  }

  // The first axis of the frame; the second is tangent x first.
  Vec3 axis(double t) const {
    const double panel = std::clamp(t / kTurn * kPanels, 0.0, kPanels - 1.0);
    const auto i = static_cast<std::size_t>(panel);
    const double angle = sums_[i].turn + integrate(panel_start(i), t).turn + closing_ * t;
    const Vec3 normal = torus_normal(t);
    const Vec3 side = jet(t).first.normalized().cross(normal);
    return std::cos(angle) * normal + std::sin(angle) * side;
  }

 private:
  struct Sums {
    double length = 0;
    double turn = 0;  // of a frame that never turns about the tangent, against the torus normal
  };
  static constexpr std::size_t kPanels = 1024;

  static double panel_start(std::size_t i) { return kTurn * static_cast<double>(i) / kPanels; }

  std::size_t panel_of(double length) const {
    const auto after =
        std::upper_bound(sums_.begin(), sums_.end(), length,
                         [](double value, const Sums& sums) { return value < sums.length; });
    const auto i = after - sums_.begin() - 1;
    return std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(i, 0)), kPanels - 1);
  }

  // Gauss-Legendre, five points.
  Sums integrate(double from, double to) const {
    constexpr std::array<std::array<double, 2>, 5> kNodes{
        {{-0.90617984593866399, 0.23692688505618909},
         {-0.53846931010568309, 0.47862867049936647},
         {0, 0.56888888888888889},
         {0.53846931010568309, 0.47862867049936647},
         {0.90617984593866399, 0.23692688505618909}}};
    Sums sums;
    const double half = (to - from) / 2;
    for (const auto& [node, weight] : kNodes) {
      const double t = (from + to) / 2 + half * node;
      const double speed = jet(t).first.norm();
      sums.length += half * weight * speed;
      sums.turn += half * weight * turn_rate(t, speed);
    }
    return sums;
  }

  double turn_rate(double t, double speed) const {
    const double c2 = std::cos(2 * t), s2 = std::sin(2 * t);
    const double c3 = std::cos(3 * t), s3 = std::sin(3 * t);
    const Vec3 rate(-3 * s3 * c2 - 2 * c3 * s2, -3 * s3 * s2 + 2 * c3 * c2, 3 * c3);
    return -rate.dot(jet(t).first.cross(torus_normal(t))) / speed;
  }

  double R_, r_;
  std::vector<Sums> sums_;  // [panel], from 0 to its start
  double closing_ = 0;      // rad of further turn per rad of parameter
};

class KnotTube : public ExactSurface {
 public:
  KnotTube(const KnotCurve& curve, double tube) : curve_(curve), tube_(tube) {
    for (std::size_t i = 0; i < kSamples; ++i) {
      const KnotCurve::Jet jet = curve.jet(kStep * static_cast<double>(i));
      samples_[i] = jet.position;
      reach_ = std::max(reach_, 1.1 * kStep * jet.first.norm());
    }
  }

  // All samples are compared, and every minimum among them that can still win is refined.
  Point nearest(const Vec3& point) const override {
    std::array<double, kSamples> distance;
    for (std::size_t i = 0; i < kSamples; ++i) distance[i] = (samples_[i] - point).norm();
    const double bound = *std::min_element(distance.begin(), distance.end()) + reach_;
    double best = std::numeric_limits<double>::infinity();
    double best_t = 0;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double before = distance[(i + kSamples - 1) % kSamples];
      const double after = distance[(i + 1) % kSamples];
      if (!(distance[i] <= bound && distance[i] <= before && distance[i] <= after)) continue;
      const double t = refine(point, kStep * static_cast<double>(i));
      const double refined = (curve_.jet(t).position - point).norm();
      if (refined < best) {
        best = refined;
        best_t = t;
      }
    }
    return nearest_at_distance(point, curve_.jet(best_t).position, tube_,
                               KnotCurve::torus_normal(best_t));
  }

 private:
  static constexpr std::size_t kSamples = 720;
  static constexpr double kStep = kTurn / kSamples;

  // Newton for a zero of (C - point) . C' within a step either way, halving where it leaves.
  double refine(const Vec3& point, double t) const {
    double low = t - kStep, high = t + kStep;
    for (int step = 0; step < 60; ++step) {
      const KnotCurve::Jet jet = curve_.jet(t);
      const Vec3 offset = jet.position - point;
      const double slope = offset.dot(jet.first);
      const double second = jet.first.squaredNorm() + offset.dot(jet.second);
      (slope > 0 ? high : low) = t;
      double next = t - slope / second;
      if (!(second > 0 && next >= low && next <= high)) next = (low + high) / 2;
      if (next == t) break;
      t = next;
    }
    return t;
  }

  KnotCurve curve_;
  double tube_;
  double reach_ = 0;  // no point of the curve is farther from both its samples
  std::array<Vec3, kSamples> samples_;
};

}  // namespace

Generated torus_knot(int along, int around, double R, double r, double tube) {
  require(along >= 3 && around >= 3, "torus_knot: at least 3 x 3 faces");
  require(R > r && r > 0 && tube > 0, "torus_knot: needs R > r > 0 and a tube");
  const KnotCurve curve(R, r);
  Mesh mesh = make_mesh(detail::message("torus_knot(", along, ", ", around, ")"));
  for (int i = 0; i < along; ++i) {
    const double t = curve.parameter_at(curve.length() * i / along);
    const KnotCurve::Jet jet = curve.jet(t);
    const Vec3 e1 = curve.axis(t);
    const Vec3 e2 = jet.first.normalized().cross(e1);
    for (int k = 0; k < around; ++k) {
      const double angle = kTurn * k / around;
      mesh.normals.push_back((std::cos(angle) * e1 + std::sin(angle) * e2).normalized());
      mesh.positions.push_back(jet.position + tube * mesh.normals.back());
    }
  }
  add_tube(mesh, along, around, true);
  share_normals(mesh);
  return {std::move(mesh), std::make_shared<KnotTube>(curve, tube)};
}

std::vector<Vec3> path_beneath(const Generated& knot, int along, int around, double depth,
                               double step) {
  const auto centre = [&](int i) {
    const int ring = i % along, column = ring * around / along;
    const auto face = static_cast<std::uint32_t>(ring * around + column);
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t s = knot.mesh.face_begin[face]; s < knot.mesh.face_begin[face + 1]; ++s) {
      sum += knot.mesh.positions[knot.mesh.corner_vertex[s]];
    }
    return Vec3(sum / knot.mesh.valence(face));
  };
  std::vector<Vec3> path;
  for (int i = 0; i < along; ++i) {
    const Vec3 here = centre(i), there = centre(i + 1);
    const int steps = static_cast<int>(std::ceil((there - here).norm() / step));
    for (int k = 0; k < steps; ++k) {
      const auto point = knot.exact->nearest(here + (there - here) * k / steps);
      path.push_back(point.position - depth * point.normal);
    }
  }
  return path;
}

}  // namespace gliss
