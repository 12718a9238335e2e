#include "gliss/build/tile_cuts.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr std::uint32_t kMostTiles = 512;  // of a patch of few sides

Vec2 corner_at(std::uint32_t n, std::uint32_t k) {
  const double angle = 2 * std::numbers::pi * k / n;
  return {std::cos(angle), std::sin(angle)};
}

// The place in a lattice of point (r, i) of fan k, the i-th of r + 1 on ring r.
struct LatticePlace {
  std::uint32_t n;
  std::uint32_t operator()(std::uint32_t k, std::uint32_t r, std::uint32_t i) const {
    return r == 0 ? 0 : 1 + n * r * (r - 1) / 2 + (k * r + i) % (n * r);
  }
};

std::uint32_t lattice_size(std::uint32_t n, std::uint32_t rings) {
  return 1 + n * rings * (rings + 1) / 2;
}

// A tile of row `row` on fan k, its j-th: towards the centre or away from it.
struct Place {
  std::uint32_t k, row, j;
  bool is_up() const { return j % 2 == 0; }
};

template <class F>
void for_tiles(std::uint32_t n, std::uint32_t levels, F f) {
  std::uint32_t tile = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    for (std::uint32_t row = 0; row < levels; ++row) {
      for (std::uint32_t j = 0; j < 2 * row + 1; ++j) f(tile++, Place{k, row, j});
    }
  }
}

// The places of the points of tiles of m rings in their lattice, [point][padded]; place(k, r, i) is
// that of point (r, i) of fan k.
template <class PlaceOf>
std::vector<std::uint32_t> points_of(std::uint32_t n, std::uint32_t levels, std::uint32_t m,
                                     PlaceOf place) {
  const std::uint32_t tiles = n * levels * levels, stride = padded(tiles);
  std::vector<std::uint32_t> index(std::size_t{(m + 1) * (m + 2) / 2} * stride);
  for_tiles(n, levels, [&](std::uint32_t tile, const Place& at) {
    std::uint32_t* to = &index[tile];
    for (std::uint32_t a = 0; a <= m; ++a) {
      for (std::uint32_t b = 0; b <= a; ++b, to += stride)
        *to = place(at.k, at.row * m + (at.is_up() ? a : b), at.j / 2 * m + (at.is_up() ? b : a));
    }
  });
  for (auto row = index.begin(); row != index.end(); row += stride)
    std::fill(row + tiles, row + stride, *row);
  return index;
}

// The domain's vectors in the two sides of a small triangle.
Eigen::Matrix2d inverse_of(const Vec2& x, const Vec2& y) {
  return (Eigen::Matrix2d() << x, y).finished().inverse();
}

std::vector<double> transforms_of(std::uint32_t n, std::uint32_t levels) {
  const std::uint32_t tiles = n * levels * levels, stride = padded(tiles),
                      rings = levels * kCutRings;
  std::vector<double> rows(kCutTransforms * stride);
  Eigen::Matrix2d up, down;  // of a fan
  const auto put = [&](std::uint32_t tile, const Place& at) {
    if (at.row == 0) {
      const Vec2 p = corner_at(n, at.k) / rings, q = corner_at(n, at.k + 1) / rings;
      up = inverse_of(p, q), down = inverse_of(q - p, q);
    }
    double* to = &rows[tile];
    for (const Eigen::Matrix2d& m : {at.is_up() ? up : down, at.is_up() ? down : up}) {
      for (const double x : {m(0, 0), m(0, 1), m(1, 0), m(1, 1)}) *to = x, to += stride;
    }
  };
  for_tiles(n, levels, put);
  for (std::uint32_t tile = tiles; tile < stride; ++tile) put(tile, {0, 0, 0});
  return rows;
}

std::vector<double> lattice_of(std::uint32_t n, std::uint32_t rings) {
  std::vector<Vec2> corner;
  for (std::uint32_t k = 0; k <= n; ++k) corner.push_back(corner_at(n, k));
  const std::uint32_t stride = padded(lattice_size(n, rings));
  std::vector<double> at(2 * std::size_t{stride});
  double *xi = at.data(), *eta = xi + stride;
  for (std::uint32_t ring = 1; ring <= rings; ++ring) {
    for (std::uint32_t k = 0; k < n; ++k) {
      for (std::uint32_t i = 0; i < ring; ++i) {
        const Vec2 X = kShrink / rings * ((ring - i) * corner[k] + i * corner[k + 1]);
        *++xi = X.x(), *++eta = X.y();
      }
    }
  }
  return at;
}

// `probe_rings`: of the probes, whose places place(k, r, i) tells.
template <class PlaceOf>
TileSamples samples_of(std::uint32_t n, std::uint32_t levels, std::uint32_t probe_rings,
                       std::uint32_t rings, PlaceOf place) {
  TileSamples s;
  if (const std::uint32_t m = probe_rings / levels; m > 0) {
    s.probe_points = (m + 1) * (m + 2) / 2;
    s.probe = points_of(n, levels, m, place);
  }
  s.rings = rings;
  s.count = padded(lattice_size(n, levels * rings));
  if (levels * rings == probe_rings) {
    s.sample = s.probe;
  } else {
    s.at = lattice_of(n, levels * rings);
    s.sample = points_of(n, levels, rings, LatticePlace{n});
  }
  return s;
}

TileCut cut_of(std::uint32_t n, std::uint32_t levels) {
  const Kernels<double>& kernel = kernels<double>();
  const std::uint32_t rings = kernel.probe_levels(n);
  TileCut cut;
  cut.levels = levels;
  cut.tiles = n * levels * levels;
  cut.padded = padded(cut.tiles);
  const bool has_gentle = kernel.probe_coarse(n) > 0;
  if (levels > 1 || !has_gentle) {
    cut.all = samples_of(n, levels, rings, kCutRings,
                         [&](std::uint32_t k, std::uint32_t r, std::uint32_t i) {
                           return r == 0 ? 0 : kernel.probe_place(n, r, (k * r + i) % (n * r));
                         });
  }
  if (has_gentle)
    cut.gentle =
        samples_of(n, levels, rings / 2, levels > 1 ? kCutFewRings : kCutRings, LatticePlace{n});
  cut.transform = transforms_of(n, levels);
  return cut;
}

}  // namespace

std::uint32_t padded(std::uint32_t count) { return (count + kCutPad - 1) / kCutPad * kCutPad; }

std::vector<TileCut> tile_cuts_of(std::uint32_t n) {
  const std::uint32_t rings = kernels<double>().probe_levels(n),
                      fewest = kernels<double>().probe_coarse(n) > 0 ? 1 : 2;
  std::vector<TileCut> cuts;
  for (std::uint32_t levels = fewest; levels <= rings && n * levels * levels <= kMostTiles;
       ++levels) {
    if (rings % levels == 0) cuts.push_back(cut_of(n, levels));
  }
  if (cuts.empty()) cuts.push_back(cut_of(n, 1));
  return cuts;
}

}  // namespace gliss
