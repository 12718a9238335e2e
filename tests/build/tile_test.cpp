// Reads tiles as searches do (kernels/tile.h) and holds their bounds to the patch between samples.
#include "gliss/build/patch_tiles.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "tests/support/numbers.h"
#include "tests/support/points.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Polygon;

struct Cut {
  PatchDraft draft;
  PatchTiles tiles;
  Vec3 low, high;
  PatchSamples samples;  // that its examination left
  std::uint32_t levels = 0;
};

Cut cut(const Polygon& polygon) {
  const auto n = static_cast<std::uint32_t>(polygon.size());
  std::vector<char> used(n + 1, 0);
  used[n] = 1;
  const ValenceTables tables = make_valence_tables(used);
  Cut c{draft_patch({polygon.positions, polygon.normals}, all_corners(n)), {}, {}, {}, {}};
  PatchDraft& d = c.draft;
  d.shape = examine(d, tables, &c.samples);
  c.low = d.shape.low, c.high = d.shape.high;
  c.tiles = cut_tiles(d.frame, d.shape, {c.low, c.high}, d.control_data(), tables, &c.samples);
  c.levels = static_cast<std::uint32_t>(
      std::lround(std::sqrt(static_cast<double>(c.tiles.words.size() / kTileUints / n))));
  return c;
}

struct Tile {
  Vec3 centre, axis;
  double radius, half, tangent, least, most;
  bool any_turn, bends;
};

Tile read(const Cut& c, std::size_t i) {
  const std::size_t count = c.tiles.words.size() / kTileUints;
  std::uint32_t w[kTileUints];
  for (std::size_t word = 0; word < kTileUints; ++word) w[word] = c.tiles.words[word * count + i];
  const Vec3 step = (c.high - c.low) / 65535;
  const double unit = 2 * step.maxCoeff();
  Tile t;
  t.centre =
      c.low + Vec3((w[0] & 65535) * step.x(), (w[0] >> 16) * step.y(), (w[1] & 65535) * step.z());
  t.radius = unit * (w[1] >> 16);
  t.half = unit * (w[3] & 65535);
  const double x = ((w[2] & 4095) - 2048.0) / 2048, y = ((w[2] >> 12 & 4095) - 2048.0) / 2048;
  t.axis = {x, y, std::sqrt(std::max(1 - x * x - y * y, 0.0))};
  const double turn = w[2] >> 24 & kTileAnyLean;
  t.any_turn = turn == kTileAnyLean;
  t.bends = (w[2] >> 24 & kTileLeansByCurvature) != 0;
  t.tangent = std::ldexp(turn * turn, -kTileLeanShift);
  const auto curvature = [&](std::uint32_t bits) {
    return std::pow((bits - 128.0) / 127, 3) * c.tiles.curvature;
  };
  t.least = curvature(w[3] >> 16 & 255), t.most = curvature(w[3] >> 24);
  return t;
}

// Points of tile i, of fan k, in the domain; none on a side of the patch.
std::vector<oracle::Vec2<double>> points_of(const Cut& c, std::size_t i) {
  constexpr int kAlong = 7;
  const int n = static_cast<int>(c.draft.valence()), levels = static_cast<int>(c.levels),
            of_fan = levels * levels, k = static_cast<int>(i) / of_fan;
  int row = 0, j = static_cast<int>(i) % of_fan;
  while ((row + 1) * (row + 1) <= j) ++row;
  j -= row * row;
  const auto corner = [&](double r, double along) -> oracle::Vec2<double> {
    if (r == 0) return {0, 0};
    return r / levels * oracle::on_side(n, k, along / r);
  };
  const double x = row, y = j / 2;
  const bool up = j % 2 == 0;
  const oracle::Vec2<double> a = corner(x, y), b = up ? corner(x + 1, y) : corner(x, y + 1),
                             e = corner(x + 1, y + 1);
  std::vector<oracle::Vec2<double>> points;
  for (int p = 0; p <= kAlong; ++p) {
    for (int q = 0; p + q <= kAlong; ++q)
      points.push_back(0.9999 * (a + (b - a) * p / kAlong + (e - a) * q / kAlong));
  }
  return points;
}

TEST(Tiles, hold_the_patch_between_their_samples) {
  Rng rng(71);
  int bounded = 0, bending = 0, gentle = 0, flattest = 0;
  for (const int n : {3, 4, 5, 6, 8, 12, 40, 130}) {
    for (int repeat = n < 9 ? -16 : 0; repeat < (n < 9 ? 6 : 1); ++repeat) {
      SCOPED_TRACE(fmt::format("{} sides, {}", n, repeat));
      const double tilt = repeat < -8 ? 0.004 : repeat < 0 ? 0.03 : 0.1 + 0.08 * repeat;
      const Polygon polygon = oracle::random_polygon(rng, n, tilt);
      const Cut c = cut(polygon);
      gentle += c.samples.is_gentle;
      flattest += c.levels == 1;
      Polygon base = polygon;
      for (Vec3& p : base.positions) p = (p - c.draft.frame.origin) * c.draft.frame.scale;
      Eigen::Matrix3d axes;
      const PatchFrame& f = c.draft.frame;
      axes << f.tangent, f.normal.cross(f.tangent), f.normal;
      const std::size_t tiles = c.tiles.words.size() / kTileUints;
      ASSERT_EQ(tiles, n * c.levels * c.levels);
      for (std::size_t i = 0; i < tiles; i += 1 + tiles / 32) {
        SCOPED_TRACE(fmt::format("tile {}", i));
        const Tile t = read(c, i);
        bounded += !t.any_turn;
        bending += t.bends;
        EXPECT_LE(t.least, t.most);
        for (const auto& X : points_of(c, i)) {
          const auto at = oracle::evaluate(base, X.x(), X.y());
          const Vec3 away = axes.transpose() * at.G - t.centre, m = axes.transpose() * at.normal;
          const double height = away.dot(t.axis);
          ASSERT_LE(std::abs(height), t.half);
          ASSERT_LE((away - height * t.axis).norm(), t.radius);
          // At the corners of many sides normals turn within less than the samples see.
          const double mean = t.bends ? 0.5 * (t.least + t.most) : 0;
          const Vec3 lean = m / m.dot(t.axis) - t.axis - mean * (away - height * t.axis);
          if (!t.any_turn && n <= 12) {
            ASSERT_LE(lean.norm(), t.tangent);
          }
        }
      }
    }
  }
  EXPECT_GT(bounded, 500);
  EXPECT_GT(bending, 100);
  EXPECT_GT(gentle, 10);
  EXPECT_GT(flattest, 10);
}

// A sphere's tiles know its curvature, positive where it bends away from the normal.
TEST(Tiles, of_a_sphere_have_its_curvature) {
  for (const double up : {1.0, -1.0}) {
    Polygon polygon;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      polygon.normals.push_back(Vec3(0.1 * x, 0.1 * y, 1).normalized());
      polygon.positions.push_back(5 * polygon.normals.back());
      polygon.positions.back().z() *= up;
      polygon.normals.back().head<2>() *= up;
    }
    const Cut c = cut(polygon);
    for (std::size_t i = 0; i < c.tiles.words.size() / kTileUints; ++i) {
      const Tile t = read(c, i);
      const double curvature = up / 5 / c.draft.frame.scale;
      EXPECT_NEAR(t.least, curvature, 0.2 * std::abs(curvature));
      EXPECT_NEAR(t.most, curvature, 0.2 * std::abs(curvature));
    }
  }
}

}  // namespace
}  // namespace gliss
