#include "gliss/build/patch_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gliss/surface/domain.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

constexpr double kMostTurn = 0.2;       // rad, of a normal from the mean of its tile, if possible
constexpr double kLittleTurn = 0.05;    // the same where a tile goes from the centre to a side
constexpr double kMostCurvature = 1e4;  // local: what curves more has no end of it
constexpr double kLeastTurn = 2e-3;  // rad: more than what two patches that meet smoothly differ by
constexpr std::uint32_t kLeanBit = 24;  // of its bits in a tile's axis

// Those of many sides are made for each patch that follows one of others: tables of all valences
// might take more memory than the surface.
const std::vector<TileCut>& cuts_of(std::uint32_t n, const ValenceTables& tables) {
  if (!tables.cuts[n].empty()) return tables.cuts[n];
  thread_local std::uint32_t last = 0;
  thread_local std::vector<TileCut> cuts;
  if (last != n) cuts = tile_cuts_of(n);
  last = n;
  return cuts;
}

}  // namespace

PatchTiles cut_tiles(const PatchFrame& frame, const PatchShape& shape, const Box& box,
                     const ControlData& control, const ValenceTables& tables,
                     const PatchSamples* samples) {
  thread_local PatchSamples own;
  thread_local std::vector<double> out;
  static const double kLeastCosine = std::cos(kMostTurn), kLeastOfOne = std::cos(kLittleTurn);
  const Kernels<double>& k = kernels<double>();
  const std::uint32_t n = control.sides;
  const auto sample = [&](const double* at, std::uint32_t count) {
    double axes[kFrameReals];
    frame.store(axes);
    own.count = count;
    own.rows.resize(kCutRows * count);
    own.stretch2 = k.sample(tables.domain_of(n), control.reals, control.form, axes, n, at,
                            at + count, count, own.rows.data());
    return &own;
  };
  if (samples == nullptr)
    samples = sample(tables.probes_of(n), static_cast<std::uint32_t>(k.probe_reals(n) / 2));
  // The fewest tiles that keep the normals of each together.
  const auto points = samples->is_gentle ? &TileCut::gentle : &TileCut::all;
  const std::vector<TileCut>& cuts = cuts_of(n, tables);
  const TileCut* cut = &cuts.front();
  for (; cut != &cuts.back(); ++cut) {
    const TileSamples& tile = cut->*points;
    if (tile.sample.empty()) continue;
    if (tile.probe_points == 0 ||
        k.least_cosine(samples->rows.data(), samples->count, tile.probe.data(), tile.probe_points,
                       cut->padded) >= (cut->levels == 1 ? kLeastOfOne : kLeastCosine))
      break;
  }
  const TileSamples& tile = cut->*points;
  if (!tile.at.empty()) samples = sample(tile.at.data(), tile.count);
  out.resize(kCutOutRows * cut->padded);
  const double bounds[] = {box.low.x(),  box.low.y(),  box.low.z(),
                           box.high.x(), box.high.y(), box.high.z()};
  const double curvature = k.cut(samples->rows.data(), samples->count, tile.sample.data(),
                                 tile.rings, cut->transform.data(), cut->padded, bounds,
                                 samples->stretch2, 1 / shape.rho_min, out.data());
  PatchTiles tiles;
  // A float's, so that it is the same number in both precisions.
  tiles.curvature =
      static_cast<double>(static_cast<float>(std::clamp(curvature, 1e-30, kMostCurvature)));
  k.add_curves(out.data(), cut->padded, tiles.curvature);
  tiles.words.resize(kTileUints * cut->tiles);
  for (std::size_t word = 0; word < kTileUints; ++word) {
    for (std::uint32_t tile = 0; tile < cut->tiles; ++tile)
      tiles.words[word * cut->tiles + tile] =
          static_cast<std::uint32_t>(out[word * cut->padded + tile]);
  }
  return tiles;
}

namespace {

// Places along an edge at which the normals on both of its sides are compared.
constexpr double kAlong[] = {1.0 / 64, 0.25, 0.5, 0.75, 63.0 / 64};
constexpr std::size_t kCompared = std::size(kAlong);

// The places along all sides of n, off them: xi and eta of each, filled up for `sample`.
struct SidePoints {
  std::uint32_t n = 0, count = 0;
  std::vector<double> xi, eta;

  explicit SidePoints(std::uint32_t sides)
      : n(sides), count(padded(static_cast<std::uint32_t>(sides * kCompared))) {
    for (std::uint32_t k = 0; k < n; ++k) {
      for (const double t : kAlong) {
        const DomainVec at = kShrink * on_side(n, k, t);
        xi.push_back(at.x()), eta.push_back(at.y());
      }
    }
    xi.resize(count), eta.resize(count);
  }
};

// Unit normals of some patches along their sides: [side][kCompared].
template <class Real>
void side_normals(const Surface<Real>& s, std::size_t begin, std::size_t end,
                  const ValenceTables& tables, LargeArray<Eigen::Vector3f>& normals) {
  constexpr double kMeshAxes[kFrameReals] = {0, 0, 1, 1, 0, 0};  // normal and tangent
  SidePoints points(0);
  std::vector<double> control, rows;
  for (std::size_t p = begin; p < end; ++p) {
    const std::uint32_t n = s.valence(static_cast<std::uint32_t>(p));
    const std::size_t first = kCompared * s.side_begin[p];
    if (points.n != n) points = SidePoints(n);
    const Real* own = &s.control[3 * std::size_t{s.control_begin[p]}];
    control.assign(own, own + kernels<double>().control_reals(s.form[p], n));
    rows.resize(kCutRows * points.count);
    kernels<double>().sample(tables.domain_of(n), control.data(), s.form[p], kMeshAxes, n,
                             points.xi.data(), points.eta.data(), points.count, rows.data());
    const double* normal = &rows[3 * points.count];
    for (std::size_t i = 0; i < n * kCompared; ++i, ++normal)
      normals[first + i] = vector_at(normal, points.count).cast<float>();
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
void free_sharp_sides(Surface<Real>& s, const ValenceTables& tables, const ParallelFor& parallel) {
  constexpr std::size_t kGrain = 64;
  LargeArray<Eigen::Vector3f> normals(s.side_twin.size() * kCompared);
  parallel(s.patch_count(), kGrain, [&](std::size_t begin, std::size_t end) {
    side_normals(s, begin, end, tables, normals);
  });
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
          axes[k * of_fan + i] |= kTileAnyLean << kLeanBit;
      }
    }
  });
}

template void free_sharp_sides(Surface<float>&, const ValenceTables&, const ParallelFor&);
template void free_sharp_sides(Surface<double>&, const ValenceTables&, const ParallelFor&);

}  // namespace gliss
