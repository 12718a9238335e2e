// Errors of patches against the oracle, with the place of the worst; and points of the domain where
// weights and slopes are hardest.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/extremes/extremes.h"
#include "tests/support/surfaces.h"

namespace gliss::test {

inline constexpr Precision kPrecisions[] = {Precision::kDouble, Precision::kFloat};
inline const char* name_of(Precision p) { return p == Precision::kFloat ? "float" : "double"; }

// A point as the cache's precision holds it: what it rounds away is the caller's loss.
inline Vec2 held(Precision precision, const Vec2& X) {
  return precision == Precision::kFloat ? X.cast<float>().cast<double>() : X;
}

// The largest of many errors, and where it was; a NaN stays.
struct WorstPlace {
  double value = 0;
  std::uint64_t count = 0;
  std::string place;

  // `where()` tells the place.
  template <class Where>
  void add(double error, Where where) {
    ++count;
    if (error <= value || std::isnan(value)) return;
    value = error;
    place = where();
  }
  void add(const WorstPlace& other) {
    add(other.value, [&] { return other.place; });
    count += other.count - 1;
  }
};

inline void hold(const Bound& bound, const WorstPlace& worst) {
  hold(bound, worst.value, worst.count);
  if (!worst.place.empty()) fmt::print("    at {}\n", worst.place);
}

// Errors of a patch against the oracle's, relative to its size; of its normal in rad, where G_xi
// and G_eta span a square as large as the patch: where they nearly coincide, no evaluator can say
// more.
struct PatchErrors {
  WorstPlace position, slope, normal;

  void add(const PatchErrors& other) {
    position.add(other.position);
    slope.add(other.slope);
    normal.add(other.normal);
  }

  template <class Where>
  void add(const SurfacePoint& got, const oracle::Sample<long double>& want, double size,
           Where where) {
    const auto narrow = [](const oracle::Vec<long double>& v) { return Vec3(v.cast<double>()); };
    const Vec3 d_xi = narrow(want.G_xi), d_eta = narrow(want.G_eta);
    // In long double: rounding what is wanted would add to the error.
    position.add(static_cast<double>((got.position.cast<long double>() - want.G).norm()) / size,
                 where);
    slope.add(std::max((got.d_xi - d_xi).norm(), (got.d_eta - d_eta).norm()) / size, where);
    const double open =
        d_xi.cross(d_eta).norm() / (std::max({d_xi.norm(), d_eta.norm(), size}) * size);
    // A flat tangent plane has no normal.
    const double turn = open > 0 ? oracle::angle<double>(got.normal, narrow(want.normal)) : 0;
    normal.add(open * turn, where);
  }
};

// Off sides and corners by 0.1 down to 1e-12, and on them; the centre, and points in between. Of at
// most `most` sides.
inline std::vector<Vec2> hard_points(oracle::Rng& rng, int n, int inside, int most) {
  std::vector<Vec2> points{Vec2::Zero()};
  for (int i = 0; i < inside; ++i) points.push_back(oracle::random_inside<double>(rng, n));
  const int sides = std::min(n, most);
  for (int i = 0; i < sides; ++i) {
    const int k = static_cast<int>((static_cast<std::int64_t>(i) * n) / sides);
    const Vec2 corner = oracle::domain_corner(n, k), middle = oracle::on_side(n, k, 0.5);
    const Vec2 inward = -middle.normalized();
    points.push_back(corner);
    points.push_back(middle);
    for (int exponent = 1; exponent <= 12; ++exponent) {
      const double distance = std::pow(10.0, -exponent);
      const Vec2 on = oracle::on_side(n, k, oracle::uniform(rng, 0, 1));
      points.push_back(on);
      points.push_back((1 - distance) * corner);
      points.push_back(oracle::on_side(n, k, distance));
      points.push_back(oracle::clamp_to_domain<double>(n, on + distance * inward));
    }
  }
  return points;
}

// Normals tilted by no more than what a corner, which turns by 2 pi / n, bears without a fold.
inline Polygon sound_polygon(oracle::Rng& rng, int n) {
  const double tilt = std::min(55 * oracle::kDegree, 0.6 * std::sqrt(2 * std::numbers::pi / n));
  return oracle::with_unit_normals(oracle::random_polygon(rng, n, tilt));
}

inline std::string place_of(int n, const Vec2& X) {
  return fmt::format("{} sides, ({:.17g}, {:.17g})", n, X.x(), X.y());
}

}  // namespace gliss::test
