#include "gliss/build/patch_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kMostTurn = 0.2;  // rad, of a normal from the mean of its tile, if possible
constexpr std::uint32_t kMostTiles = 512;  // of a patch of few sides
constexpr double kMostCurvature = 1e4;     // local: what curves more has no end of it
constexpr double kShrink = 1 - 0x1p-16;    // of the samples' domain: off the sides
constexpr std::uint32_t kRings = 4;        // of samples in a tile, at least
// Between samples, normals turn so much farther and curvatures range so much farther.
constexpr double kMoreTurn = 1.25, kMoreCurvature = 0.5;
constexpr double kLeastTurn = 2e-3;  // rad: more than what two patches that meet smoothly differ by
constexpr std::uint32_t kTurnShift = 24;  // of its bits in a tile's axis

Vec2 domain_corner(std::uint32_t n, std::uint32_t k) {
  const double angle = 2 * std::numbers::pi * k / n;
  return {std::cos(angle), std::sin(angle)};
}

// The least and the largest of some numbers. NaN counts as no bound at all.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    low = x >= low ? low : std::isnan(x) ? -kMostCurvature : x;
    high = x <= high ? high : std::isnan(x) ? kMostCurvature : x;
  }
  double wide() const { return high - low; }
};

struct Sample {
  Vec3 position, normal;  // along tangent, normal x tangent, normal
};

// The samples of a patch: a lattice on the triangle from its centre to each side, `rings` rows of
// triangles; point (r, i) of fan k is the i-th of r + 1 on ring r.
class Lattice {
 public:
  Lattice(const PatchFrame& frame, const double* control, std::uint32_t form, std::uint32_t n,
          std::uint32_t rings, const ValenceTables& tables)
      : n_(n), rings_(rings) {
    for (std::uint32_t k = 0; k <= n; ++k) corners_.push_back(domain_corner(n, k));
    std::vector<double> xi{0}, eta{0};
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
      for (std::uint32_t k = 0; k < n; ++k) {
        for (std::uint32_t i = 0; i < ring; ++i) {
          const Vec2 at = kShrink / rings * ((ring - i) * corners_[k] + i * corners_[k + 1]);
          xi.push_back(at.x()), eta.push_back(at.y());
        }
      }
    }
    const std::size_t count = xi.size();
    std::vector<double> rows(9 * count);
    kernels<double>().evaluate(tables.domain_of(n), control, form, n, xi.data(), eta.data(), count,
                               count, rows.data());
    Eigen::Matrix3d axes;
    axes << frame.tangent, frame.normal.cross(frame.tangent), frame.normal;
    const Eigen::Matrix3d turn = axes.transpose();
    samples_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = [&](std::size_t r) {
        return Vec3(rows[r * count + i], rows[(r + 1) * count + i], rows[(r + 2) * count + i]);
      };
      const Vec3 d_xi = row(3), d_eta = row(6);
      samples_[i] = {turn * row(0), turn * d_xi.cross(d_eta).normalized()};
      stretch2_ = std::max({stretch2_, d_xi.squaredNorm(), d_eta.squaredNorm()});
    }
    find_curvatures();
  }

  std::uint32_t sides() const { return n_; }
  std::uint32_t rings() const { return rings_; }
  double stretch() const { return std::sqrt(stretch2_); }

  const Sample& at(std::uint32_t k, std::uint32_t r, std::uint32_t i) const {
    return samples_[r == 0 ? 0 : 1 + n_ * r * (r - 1) / 2 + (k * r + i) % (n_ * r)];
  }

  // Measures a small triangle: signed principal curvatures, positive where the surface bends away
  // from its normal, and the longest side squared. `up`: (r, i), (r + 1, i), (r + 1, i + 1), else
  // (r, i), (r, i + 1), (r + 1, i + 1).
  struct Bend {
    double low, high, longest2;
    Eigen::Matrix2d second;  // fundamental form, of the domain
  };
  const Bend& bend(std::uint32_t k, std::uint32_t r, std::uint32_t i, bool up) const {
    return bends_[std::size_t{k} * rings_ * rings_ + r * r + 2 * i + !up];
  }

 private:
  void find_curvatures() {
    bends_.reserve(std::size_t{n_} * rings_ * rings_);
    for (std::uint32_t k = 0; k < n_; ++k) {
      const Vec2 p = corners_[k] / rings_, q = corners_[k + 1] / rings_;
      const Eigen::Matrix2d up = inverse_of(p, q), down = inverse_of(q - p, q);
      for (std::uint32_t r = 0; r < rings_; ++r) {
        for (std::uint32_t j = 0; j < 2 * r + 1; ++j) {
          const std::uint32_t i = j / 2;
          const Sample &a = at(k, r, i), &c = at(k, r + 1, i + 1),
                       &b = j % 2 == 0 ? at(k, r + 1, i) : at(k, r, i + 1);
          bends_.push_back(bend_of(a, b, c, j % 2 == 0 ? up : down));
        }
      }
    }
  }

  static Eigen::Matrix2d inverse_of(const Vec2& x, const Vec2& y) {
    return (Eigen::Matrix2d() << x, y).finished().inverse();
  }

  // By the turn of the normals along two sides (Rusinkiewicz 2004); `sides`: the inverse of theirs
  // in the domain.
  static Bend bend_of(const Sample& a, const Sample& b, const Sample& c,
                      const Eigen::Matrix2d& sides) {
    const Vec3 u = b.position - a.position, v = c.position - a.position,
               turn_u = b.normal - a.normal, turn_v = c.normal - a.normal;
    const double e = u.squaredNorm(), f = u.dot(v), g = v.squaredNorm(), det = e * g - f * f;
    const double l = turn_u.dot(u), m = 0.5 * (turn_u.dot(v) + turn_v.dot(u)), n = turn_v.dot(v);
    const double mean = 0.5 * (e * n - 2 * f * m + g * l) / det, gauss = (l * n - m * m) / det;
    const double apart = std::sqrt(std::max(mean * mean - gauss, 0.0));
    const double longest2 = std::max({e, g, (v - u).squaredNorm()});
    const Eigen::Matrix2d form = (Eigen::Matrix2d() << -l, -m, -m, -n).finished();
    const Eigen::Matrix2d second = sides.transpose() * form * sides;
    if (!(det > 1e-12 * longest2 * longest2))
      return {-kMostCurvature, kMostCurvature, longest2, second};
    return {mean - apart, mean + apart, longest2, second};
  }

  std::uint32_t n_, rings_;
  std::vector<Vec2> corners_;  // of the domain
  std::vector<Sample> samples_;
  std::vector<Bend> bends_;
  double stretch2_ = 0;
};

// The triangle of lattice points and small triangles that a tile covers.
struct Tile {
  std::uint32_t k, r, i, m;  // fan; its first point; rings along its side
  bool up;

  template <class F>
  void for_points(const Lattice& lattice, F f) const {
    for (std::uint32_t a = 0; a <= m; ++a) {
      for (std::uint32_t b = up ? 0 : a; b <= (up ? a : m); ++b) f(lattice.at(k, r + a, i + b));
    }
  }
  template <class F>
  void for_bends(const Lattice& lattice, F f) const {
    for (std::uint32_t a = 0; a < m; ++a) {
      for (std::uint32_t b = up ? 0 : a; b < (up ? a + 1 : m); ++b) {
        if (up || b > a) f(lattice.bend(k, r + a, i + b, true));
        if (!up || b < a) f(lattice.bend(k, r + a, i + b, false));
      }
    }
  }
};

template <class F>
void for_tiles(const Lattice& lattice, std::uint32_t levels, F f) {
  const std::uint32_t m = lattice.rings() / levels;
  for (std::uint32_t k = 0; k < lattice.sides(); ++k) {
    for (std::uint32_t r = 0; r < levels; ++r) {
      for (std::uint32_t j = 0; j < 2 * r + 1; ++j) f(Tile{k, r * m, j / 2 * m, m, j % 2 == 0});
    }
  }
}

Vec3 mean_normal(const Lattice& lattice, const Tile& tile) {
  Vec3 sum = Vec3::Zero();
  tile.for_points(lattice, [&](const Sample& s) { sum += s.normal; });
  return sum.normalized();
}

double least_cosine(const Lattice& lattice, std::uint32_t levels) {
  double least = 1;
  for_tiles(lattice, levels, [&](const Tile& tile) {
    const Vec3 mean = mean_normal(lattice, tile);
    tile.for_points(lattice, [&](const Sample& s) { least = std::min(least, s.normal.dot(mean)); });
  });
  return least;
}

// Rows of tiles: as few as keep the normals of each together, two at least.
std::uint32_t levels_of(const Lattice& lattice) {
  std::uint32_t levels = 1;
  for (std::uint32_t next = 2; next <= lattice.rings(); ++next) {
    if (lattice.rings() % next != 0) continue;
    if (lattice.sides() * next * next > kMostTiles) break;
    levels = next;
    if (least_cosine(lattice, levels) >= std::cos(kMostTurn)) break;
  }
  return levels;
}

std::uint32_t code(double x, double most) {
  return static_cast<std::uint32_t>(std::clamp(std::isnan(x) ? most : x, 0.0, most));
}

// Writes tiles relative to the box and the largest curvature.
class TileWriter {
 public:
  TileWriter(const Lattice& lattice, const Vec3& low, const Vec3& high, double curvature)
      : lattice_(lattice),
        low_(low),
        step_((high - low) / 65535),
        unit_(2 * step_.maxCoeff()),
        curvature_(curvature) {}

  void write(const Tile& tile, std::vector<std::uint32_t>& words) const {
    Vec3 axis = mean_normal(lattice_, tile);
    const double sign = axis.z() < 0 ? -1 : 1;
    std::uint32_t axis_word = write_axis(sign * axis, axis);
    Vec3 middle = Vec3::Zero();
    double top = -std::numeric_limits<double>::infinity(), bottom = -top, count = 0;
    tile.for_points(lattice_, [&](const Sample& s) { middle += s.position, ++count; });
    middle /= count;
    tile.for_points(lattice_, [&](const Sample& s) {
      const double height = (s.position - middle).dot(axis);
      top = std::max(top, height), bottom = std::min(bottom, height);
    });
    std::uint32_t centre[3];
    for (int i = 0; i < 3; ++i) {
      const double at = middle[i] + 0.5 * (top + bottom) * axis[i];
      centre[i] = step_[i] > 0 ? code((at - low_[i]) / step_[i] + 0.5, 65535) : 0;
      middle[i] = low_[i] + centre[i] * step_[i];
    }
    const Extent extent = extent_of(tile, middle, axis);
    const std::uint32_t curve_bits = curves(tile, sign);
    axis_word |= turn(tile, middle, axis, sign, extent.radius, mean_curvature(curve_bits))
                 << kTurnShift;
    words.push_back(centre[0] | centre[1] << 16);
    words.push_back(centre[2] | code(std::ceil(extent.radius / unit_), 65535) << 16);
    words.push_back(axis_word);
    words.push_back(code(std::ceil(extent.half / unit_), 65535) | curve_bits << 16);
    words.push_back(second(tile));
  }

 private:
  struct Extent {
    double radius = 0, half = 0;
  };

  // `axis` becomes what is read.
  static std::uint32_t write_axis(const Vec3& from, Vec3& axis) {
    const std::uint32_t x = code(2048 + std::trunc(2047 * from.x()), 4095),
                        y = code(2048 + std::trunc(2047 * from.y()), 4095);
    axis.x() = (x - 2048.0) / 2048;
    axis.y() = (y - 2048.0) / 2048;
    axis.z() = std::sqrt(std::max(1 - axis.head<2>().squaredNorm(), 0.0));
    return x | y << 12;
  }

  // The bits of how far normals lean from the axis, at most: by more than the mean curvature says,
  // if beneath the patch that bounds them better.
  std::uint32_t turn(const Tile& tile, const Vec3& middle, const Vec3& axis, double sign,
                     double radius, double mean) const {
    double least = 1, rest = 0;
    tile.for_points(lattice_, [&](const Sample& s) {
      const double cosine = sign * s.normal.dot(axis);
      least = cosine >= least ? least : std::isnan(cosine) ? -1 : cosine;
      const Vec3 away = s.position - middle, lean = s.normal / (sign * cosine) - axis;
      rest = std::max(rest, (lean - mean * (away - away.dot(axis) * axis)).norm());
    });
    const double angle = kMoreTurn * std::acos(std::max(least, -1.0)) + kLeastTurn;
    if (!(angle < std::numbers::pi / 2)) return kTileAnyTurn;
    const double all = std::tan(angle),
                 more = std::max(kMoreTurn * rest, rest + 0.5 * (kMoreTurn - 1) * all) + kLeastTurn;
    const bool bends = more < all && more - radius * sign * mean < all;
    return turn_bits(bends ? more : all) | (bends ? kTileBends : 0);
  }
  static std::uint32_t turn_bits(double tangent) {
    return code(std::ceil(std::sqrt(std::ldexp(tangent, kTileTurnShift))), kTileAnyTurn);
  }

  // As it is read.
  double mean_curvature(std::uint32_t bits) const {
    const auto cube = [](double x) { return x * x * x; };
    return 0.5 * curvature_ *
           (cube(((bits & 255) - 128.0) / 127) + cube(((bits >> 8) - 128.0) / 127));
  }

  Extent extent_of(const Tile& tile, const Vec3& middle, const Vec3& axis) const {
    double slack = 0;
    Extent e;
    tile.for_bends(lattice_, [&](const Lattice::Bend& b) {
      const double bend = std::max(-b.low, b.high);
      slack = std::max(slack, std::min(std::sqrt(b.longest2), b.longest2 * bend * (1.5 / 8)));
    });
    slack += 2e-5 * lattice_.stretch();  // the outermost samples are not quite on the sides
    tile.for_points(lattice_, [&](const Sample& s) {
      const Vec3 away = s.position - middle;
      const double height = away.dot(axis);
      e.half = std::max(e.half, std::abs(height));
      e.radius = std::max(e.radius, (away - height * axis).norm());
    });
    return {e.radius + slack, e.half + slack};
  }

  std::uint32_t curves(const Tile& tile, double sign) const {
    Range lows, highs;
    tile.for_bends(lattice_, [&](const Lattice::Bend& b) { lows.add(b.low), highs.add(b.high); });
    double least = lows.low - kMoreCurvature * lows.wide(),
           most = highs.high + kMoreCurvature * highs.wide();
    if (sign < 0) least = -std::exchange(most, -least);
    const auto root = [&](double c) { return 127 * std::cbrt(c / curvature_); };
    return code(std::floor(128 + root(least)), 255) | code(std::ceil(128 + root(most)), 255) << 8;
  }

  std::uint32_t second(const Tile& tile) const {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    double count = 0;
    tile.for_bends(lattice_, [&](const Lattice::Bend& b) { sum += b.second, ++count; });
    if (!sum.allFinite()) sum.setZero();
    sum /= count;
    int exponent = -16;
    while (exponent < 15 && sum.cwiseAbs().maxCoeff() >= std::ldexp(1.0, exponent)) ++exponent;
    const auto bits = [&](double x) { return code(256.5 + std::ldexp(x, 8 - exponent), 511); };
    return bits(sum(0, 0)) | bits(sum(0, 1)) << 9 | bits(sum(1, 1)) << 18 |
           static_cast<std::uint32_t>(exponent + 16) << 27;
  }

  const Lattice& lattice_;
  const Vec3 low_, step_;
  const double unit_, curvature_;
};

}  // namespace

PatchTiles cut_tiles(const PatchFrame& frame, const PatchShape& shape, const Vec3& low,
                     const Vec3& high, const double* control, std::uint32_t form, std::uint32_t n,
                     const ValenceTables& tables) {
  const std::uint32_t rings = kernels<double>().probe_levels(n);
  Lattice lattice(frame, control, form, n, rings, tables);
  const std::uint32_t levels = levels_of(lattice);
  if (levels * kRings > rings) lattice = Lattice(frame, control, form, n, levels * kRings, tables);
  PatchTiles tiles;
  tiles.curvature = 1 / shape.rho_min;
  for_tiles(lattice, 1, [&](const Tile& tile) {
    tile.for_bends(lattice, [&](const Lattice::Bend& b) {
      tiles.curvature = std::max({tiles.curvature, -b.low, b.high});
    });
  });
  // A float's, so that it is the same number in both precisions.
  tiles.curvature =
      static_cast<double>(static_cast<float>(std::clamp(tiles.curvature, 1e-30, kMostCurvature)));
  const TileWriter writer(lattice, low, high, tiles.curvature);
  tiles.words.reserve(kTileUints * n * levels * levels);
  for_tiles(lattice, levels, [&](const Tile& tile) { writer.write(tile, tiles.words); });
  return tiles;
}

namespace {

// Places along an edge at which the normals on both of its sides are compared.
constexpr double kAlong[] = {1.0 / 64, 0.25, 0.5, 0.75, 63.0 / 64};
constexpr std::size_t kCompared = std::size(kAlong);

// Unit normals of some patches along their sides: [side][kCompared].
template <class Real>
void side_normals(const Surface<Real>& s, std::size_t begin, std::size_t end,
                  LargeArray<Eigen::Vector3f>& normals) {
  std::vector<Real> xi, eta, rows;
  for (std::size_t p = begin; p < end; ++p) {
    const std::uint32_t n = s.valence(static_cast<std::uint32_t>(p)), first = s.side_begin[p];
    const std::size_t count = n * kCompared;
    if (xi.size() != count) {
      xi.clear(), eta.clear();
      for (std::uint32_t k = 0; k < n; ++k) {
        for (const double t : kAlong) {
          const Vec2 at = kShrink * ((1 - t) * domain_corner(n, k) + t * domain_corner(n, k + 1));
          xi.push_back(static_cast<Real>(at.x())), eta.push_back(static_cast<Real>(at.y()));
        }
      }
      rows.resize(9 * count);
    }
    kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                             &s.control[3 * std::size_t{s.control_begin[p]}], s.form[p], n,
                             xi.data(), eta.data(), count, count, rows.data());
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = [&](std::size_t r) {
        return Vec3(static_cast<double>(rows[r * count + i]),
                    static_cast<double>(rows[(r + 1) * count + i]),
                    static_cast<double>(rows[(r + 2) * count + i]));
      };
      const Vec3 d_xi = row(3), d_eta = row(6);
      normals[first * kCompared + i] = d_xi.cross(d_eta).normalized().cast<float>();
    }
  }
}

bool is_smooth(const LargeArray<Eigen::Vector3f>& normals, std::uint32_t side, std::uint32_t twin) {
  for (std::size_t i = 0; i < kCompared; ++i) {
    const Eigen::Vector3f apart =
        normals[side * kCompared + i] - normals[(twin + 1) * kCompared - 1 - i];
    if (!(apart.cast<double>().norm() < 0.5 * kLeastTurn)) return false;
  }
  return true;
}

}  // namespace

template <class Real>
void free_sharp_sides(Surface<Real>& s, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 64;
  LargeArray<Eigen::Vector3f> normals(s.side_twin.size() * kCompared);
  parallel(s.patch_count(), kGrain,
           [&](std::size_t begin, std::size_t end) { side_normals(s, begin, end, normals); });
  parallel(s.patch_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::uint32_t first = s.side_begin[p], n = s.side_begin[p + 1] - first;
      const std::uint32_t count = s.tile_begin[p + 1] - s.tile_begin[p], of_fan = count / n;
      const auto axes =
          s.tile.begin() + kTileUints * std::size_t{s.tile_begin[p]} + kTileAxis * count;
      const auto levels = static_cast<std::uint32_t>(std::lround(std::sqrt(of_fan)));
      for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t twin = s.side_twin[first + k];
        if (twin != kNone && is_smooth(normals, first + k, twin)) continue;
        for (std::uint32_t i = (levels - 1) * (levels - 1); i < of_fan; ++i)
          axes[k * of_fan + i] |= kTileAnyTurn << kTurnShift;
      }
    }
  });
}

template void free_sharp_sides(Surface<float>&, const ParallelFor&);
template void free_sharp_sides(Surface<double>&, const ParallelFor&);

}  // namespace gliss
