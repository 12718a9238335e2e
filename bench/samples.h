// The points at which patches are sampled: the same for us and for peers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

namespace gliss::bench {

inline constexpr std::size_t kPatchPoints = 256;  // of a patch, when many are asked for at once
// The kernel's benchmark takes about so many patches at once, a call of a library so many points.
inline constexpr std::size_t kCallPatches = 1024, kCallPoints = 65536;

// A quad's own parameters: u from corner 0 to 1, v from corner 0 to 3.
struct QuadPoint {
  float u, v;
};
inline QuadPoint quad_point(double xi, double eta) {
  return {static_cast<float>(0.5 * (1 - xi + eta)), static_cast<float>(0.5 * (1 - xi - eta))};
}

// A grid: all over a quad, for near corners peers do more; else well within the domain.
template <class Real>
struct PatchGrid {
  std::vector<Real> xi, eta;
  explicit PatchGrid(std::uint32_t n) {
    const double size = n == 4 ? 1 : 0.3;
    for (std::size_t i = 0; i < kPatchPoints; ++i) {
      const double u = (static_cast<double>(i % 16) + 0.5) / 16,
                   v = (static_cast<double>(i / 16) + 0.5) / 16;
      xi.push_back(static_cast<Real>(size * (1 - u - v)));
      eta.push_back(static_cast<Real>(size * (u - v)));
    }
  }
};

// By patch, many points of each; or one point a patch, in random order, as those of unrelated HIPs
// are.
enum class Order { kByPatch, kShuffled };

// The points of a call, of `patches` polygons of n sides; shuffled ones are of quads.
template <class Real>
struct CallPoints {
  std::vector<std::uint32_t> patch;
  std::vector<Real> xi, eta;
  CallPoints(Order order, std::size_t patches, std::uint32_t n = 4) {
    if (order == Order::kByPatch) {
      const PatchGrid<Real> grid(n);
      for (std::size_t i = 0; i < kCallPoints; ++i) {
        patch.push_back(static_cast<std::uint32_t>(i / kPatchPoints % patches));
        xi.push_back(grid.xi[i % kPatchPoints]);
        eta.push_back(grid.eta[i % kPatchPoints]);
      }
      return;
    }
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.01, 0.99);
    for (std::size_t i = 0; i < kCallPoints; ++i) {
      const double u = uniform(random), v = uniform(random);
      patch.push_back(static_cast<std::uint32_t>(i % patches));
      xi.push_back(static_cast<Real>(1 - u - v));
      eta.push_back(static_cast<Real>(u - v));
    }
    std::shuffle(patch.begin(), patch.end(), random);
  }
};

}  // namespace gliss::bench
