// Weights (eq. 5) of 3 to 1000 sides, alone and in the patches that they blend.
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"
#include "tests/extremes/extreme_errors.h"
#include "tests/oracle/fair_oracle.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::hold, test::held, test::name_of, test::Polygon, test::Vec2, test::WorstPlace;

// Around where plain products begin to fail: in float from 64 sides, in double from 480.
std::vector<int> all_sides() {
  std::vector<int> sides;
  for (int n = 3; n <= 20; ++n) sides.push_back(n);
  for (const int n : {32, 64, 68, 72, 80, 100, 128, 256, 480, 512, 1000}) sides.push_back(n);
  return sides;
}

// A patch whose sides are points and whose cross tangents vanish: each corner interpolator is the
// constant of the side before its corner, and G is their blend.
template <class Real>
class Blend {
 public:
  explicit Blend(int n) : n_(static_cast<std::uint32_t>(n)), begin_(n_ + 1, 0) {
    append_domain(n_, domain_, begin_);
    std::vector<Real> corners;
    for (int k = 0; k < n; ++k) {
      const Vec2 X = oracle::domain_corner(n, k);
      for (const double x : {X.x(), X.y(), 0.0, 0.0, 0.0, 1.0})
        corners.push_back(static_cast<Real>(x));
    }
    control_.resize(n_ * kSideReals);
    const Real up[] = {0, 0, 1};
    Real soundness = 0;
    kernels<Real>().build_patches(corners.data(), n_, 1, control_.data(), &soundness);
    for (std::uint32_t k = 0; k < n_; ++k) {
      Real* side = &control_[k * kSideReals];
      side[kSideLength] = side[kSideLength + 1] = 0;
    }
    kernels<Real>().flatten_tangents(control_.data(), n_, up);
    for (std::uint32_t k = 0; k < n_; ++k) std::fill_n(&control_[k * kSideReals], 12, Real(0));
  }

  // The weights of three corners.
  Vec3 weights(const Vec2& X, const std::array<int, 3>& corners) {
    const auto blend = [&](Real height) {
      for (std::size_t i = 0; i < 3; ++i)
        control_[(static_cast<std::size_t>(corners[i]) + n_ - 1) % n_ * kSideReals + i] = height;
    };
    blend(1);
    const auto xi = static_cast<Real>(X.x()), eta = static_cast<Real>(X.y());
    Real rows[9];
    kernels<Real>().evaluate(&domain_[begin_[n_]], control_.data(), kFormPaper, n_, &xi, &eta, 1, 1,
                             rows);
    blend(0);
    return {static_cast<double>(rows[0]), static_cast<double>(rows[1]),
            static_cast<double>(rows[2])};
  }

 private:
  std::uint32_t n_;
  std::vector<Real> domain_, control_;
  std::vector<std::uint32_t> begin_;
};

// The corners that weigh most, and some others.
std::vector<std::array<int, 3>> corners_to_judge(Rng& rng, const std::vector<oracle::Jet>& w) {
  const int n = static_cast<int>(w.size());
  std::vector<int> order(w.size());
  for (int k = 0; k < n; ++k) order[static_cast<std::size_t>(k)] = k;
  const auto weight = [&](int k) { return w[static_cast<std::size_t>(k)].value; };
  std::partial_sort(order.begin(), order.begin() + std::min(n, 6), order.end(),
                    [&](int a, int b) { return weight(a) > weight(b); });
  std::shuffle(order.begin() + std::min(n, 6), order.end(), rng);
  std::vector<std::array<int, 3>> triples;
  for (std::size_t i = 0; i + 2 < std::min<std::size_t>(w.size(), 12); i += 3)
    triples.push_back({order[i], order[i + 1], order[i + 2]});
  return triples;
}

template <class Real>
WorstPlace weights_against_oracle(Precision precision) {
  Rng rng(101);
  WorstPlace worst;
  for (const int n : all_sides()) {
    Blend<Real> blend(n);
    const int inside = static_cast<int>(test::samples(20, 400));
    for (const Vec2& free : test::hard_points(rng, n, inside, inside < 100 ? 4 : 32)) {
      const Vec2 X = held(precision, free);
      const std::vector<oracle::Jet> want = oracle::weight_jets(n, X.x(), X.y());
      for (const auto& corners : corners_to_judge(rng, want)) {
        const Vec3 got = blend.weights(X, corners);
        for (int i = 0; i < 3; ++i) {
          const long double w =
              want[static_cast<std::size_t>(corners[static_cast<std::size_t>(i)])].value;
          worst.add(static_cast<double>(std::abs(static_cast<long double>(got[i]) - w)),
                    [&] { return test::place_of(n, X); });
        }
      }
    }
  }
  return worst;
}

TEST(ExtremeWeights, are_those_of_long_double) {
  hold({"Numbers: patches", "weights of 3 to 1000 sides, double", 1e-13},
       weights_against_oracle<double>(Precision::kDouble));
  hold({"Numbers: patches", "weights of 3 to 1000 sides, float", 2e-6, 2e-5,
        "that of the nearest side is read as 1 less the sum of all others"},
       weights_against_oracle<float>(Precision::kFloat));
}

// Sides and corners, in double.
TEST(ExtremeWeights, leave_the_boundary_where_it_is) {
  Rng rng(102);
  WorstPlace side, corner;
  for (const int n : all_sides()) {
    for (std::uint64_t i = 0; i < test::samples(2, 40); ++i) {
      const Polygon polygon = test::sound_polygon(rng, n);
      const PatchCache cache =
          test::paper_cache_of(test::mesh_of(polygon), Precision::kDouble, false);
      const auto exact = oracle::cast<long double>(polygon);
      const double size = oracle::size_of(polygon);
      const auto gap = [&](const Vec2& X, const oracle::Vec<long double>& want) {
        const Vec3 got = test::at(cache, 0, X).position;
        return static_cast<double>((got.cast<long double>() - want).norm()) / size;
      };
      for (int j = 0; j < 60; ++j) {
        const int k = static_cast<int>(rng() % static_cast<std::uint64_t>(n));
        const double t = oracle::uniform(rng, 0, 1);
        const Vec2 X = oracle::on_side(n, k, t), C = oracle::domain_corner(n, k);
        side.add(gap(X, oracle::side(exact, k, static_cast<long double>(t)).C),
                 [&] { return test::place_of(n, X); });
        corner.add(gap(C, exact.position(k)), [&] { return test::place_of(n, C); });
      }
    }
  }
  hold({"Numbers: patches", "boundary curves, of size, 3 to 1000 sides, double", 1e-14, 2e-14,
        "n^2 roundings are lost between the sides next to a side"},
       side);
  hold({"Numbers: patches", "corners, of size, 3 to 1000 sides, double", 2e-15}, corner);
}

class ExtremePatch : public ::testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(, ExtremePatch, ::testing::ValuesIn(test::kPrecisions),
                         [](const auto& info) { return name_of(info.param); });

// A row for each range of sides: roundings grow with n^2.
const std::vector<std::vector<int>> kRanges{
    {3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20},
    {32},
    {64, 68, 72, 80, 100},
    {128, 256},
    {480, 512, 1000}};

test::PatchErrors errors_of(Rng& rng, Precision precision, int n) {
  test::PatchErrors errors;
  const std::uint64_t polygons = test::samples(n > 100 ? 1 : n > 20 ? 2 : 4, n > 100 ? 4 : 40);
  for (std::uint64_t i = 0; i < polygons; ++i) {
    const Polygon polygon = test::sound_polygon(rng, n);
    const PatchCache cache = test::paper_cache_of(test::mesh_of(polygon), precision, false);
    const auto exact = oracle::cast<long double>(polygon);
    const double size = oracle::size_of(polygon);
    for (const Vec2& free : test::hard_points(rng, n, 40, n > 100 ? 2 : 6)) {
      const Vec2 X = held(precision, free);
      errors.add(test::at(cache, 0, X), oracle::evaluate(exact, X), size,
                 [&] { return test::place_of(n, X); });
    }
  }
  return errors;
}

TEST_P(ExtremePatch, has_the_position_and_slopes_of_long_double) {
  const Precision precision = GetParam();
  const bool is_float = precision == Precision::kFloat;
  Rng rng(103);
  for (const std::vector<int>& range : kRanges) {
    test::PatchErrors errors;
    for (const int n : range) errors.add(errors_of(rng, precision, n));
    const int most = range.back();
    const std::string sides = range.size() == 1 ? fmt::format("{} sides", most)
                                                : fmt::format("{} to {} sides", range[0], most);
    const auto row = [&](const char* what, double goal, const WorstPlace& worst, double limit) {
      hold({"Numbers: patches", fmt::format("{}, {}, {}", what, sides, name_of(precision)), goal,
            std::max(goal, limit), "n^2 roundings are lost between the sides next to a side"},
           worst);
    };
    const double lost = 2 * most * most * (is_float ? 0x1p-24 : 0x1p-53);
    row("position, of size", is_float ? 2e-6 : 1e-13, errors.position,
        is_float && most >= 256 ? 6e-6 : 0);
    row("slopes, of size", is_float ? 5e-6 : 1e-13, errors.slope, lost);
    row("normal, rad", is_float ? 5e-6 : 1e-13, errors.normal, lost);
  }
}

// Quads have no oracle: fair_test.cpp holds what their steps ask of them.
TEST_P(ExtremePatch, of_a_fair_triangle_has_the_position_and_slopes_of_long_double) {
  const bool is_float = GetParam() == Precision::kFloat;
  Rng rng(104);
  test::PatchErrors errors;
  for (std::uint64_t i = 0; i < test::samples(20, 800); ++i) {
    const Polygon polygon = test::sound_polygon(rng, 3);
    const Mesh mesh = test::mesh_of(polygon);
    const Topology topology = build_topology(mesh);
    const PatchCache cache = test::cache_of(mesh, GetParam(), false, nullptr, Construction::kFair);
    const oracle::Fair fair(mesh, topology);
    for (const Vec2& free : test::hard_points(rng, 3, 40, 3)) {
      const Vec2 X = held(GetParam(), free);
      errors.add(test::at(cache, 0, X), fair.evaluate(0, X), oracle::size_of(polygon),
                 [&] { return test::place_of(3, X); });
    }
  }
  const auto row = [&](const char* what, double goal, const WorstPlace& worst) {
    hold({"Numbers: patches", fmt::format("{}, fair triangles, {}", what, name_of(GetParam())),
          goal},
         worst);
  };
  row("position, of size", is_float ? 2e-6 : 1e-13, errors.position);
  row("slopes, of size", is_float ? 5e-6 : 1e-13, errors.slope);
  row("normal, rad", is_float ? 5e-6 : 1e-13, errors.normal);
}

}  // namespace
}  // namespace gliss
