#include "gliss/query/texture.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace gliss {
namespace {

// Noise is from -1 to 1, as its gradients have length 2 / sqrt(3). kNoiseSlope bounds its slope,
// over all gradients of a cell and all places in it.
constexpr double kNoiseSlope = 3.23;

// From the middle of a cube to the middles of its edges, by three bits of a cell's hash and one
// more (Perlin 2002).
Vec3 gradient_of(std::uint32_t hash) {
  static const std::array<Vec3, 16> ways = [] {
    constexpr int kWays[16][3] = {{1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0},
                                  {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
                                  {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1},
                                  {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1}};
    std::array<Vec3, 16> unit;
    for (std::size_t i = 0; i < 16; ++i)
      unit[i] = std::sqrt(2.0 / 3) * Vec3(kWays[i][0], kWays[i][1], kWays[i][2]);
    return unit;
  }();
  return ways[hash & 15u];
}

// A hash of a cell's corner (the finalizer of MurmurHash3, by A. Appleby).
std::uint32_t hash_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u ^
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fu ^
                    static_cast<std::uint64_t>(z) * 0x165667b19e3779f9u;
  h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
  h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
  return static_cast<std::uint32_t>((h ^ (h >> 33)) >> 16);
}

// Noise and its gradient, in cells.
Texture::Place noise_at(const Vec3& at) {
  const Vec3 cell = at.array().floor(), t = at - cell;
  const Vec3 fade = t.array().cube() * (t.array() * (6 * t.array() - 15) + 10),
             rise = 30 * t.array().square() * (t.array() - 1).square();
  Texture::Place sum{0, Vec3::Zero()};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 to(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
    const Vec3 gradient = gradient_of(hash_of(static_cast<std::int64_t>(cell.x() + to.x()),
                                              static_cast<std::int64_t>(cell.y() + to.y()),
                                              static_cast<std::int64_t>(cell.z() + to.z())));
    const Vec3 share = (to.array() > 0).select(fade, Vec3::Ones() - fade),
               slope = (to.array() > 0).select(rise, -rise);
    const double f = gradient.dot(t - to);
    sum.height += share.prod() * f;
    sum.slope += share.prod() * gradient + f * Vec3(slope.x() * share.y() * share.z(),
                                                    share.x() * slope.y() * share.z(),
                                                    share.x() * share.y() * slope.z());
  }
  return sum;
}

}  // namespace

const char* fault_of(const TextureOptions& options) noexcept {
  if (options.relief == Relief::kNone) return nullptr;
  if (!(options.height >= 0 && std::isfinite(options.height)))
    return "has a texture whose height is not 0 or more";
  if (!(options.period > 0 && std::isfinite(options.period)))
    return "has a texture whose period is not above 0";
  if (!(options.along.allFinite() && !options.along.isZero(0)))
    return "has a texture along no direction";
  return Texture(options).steepest() <= Texture::kSteepest
             ? nullptr
             : "has a texture that is too steep: it needs less height or a longer period";
}

Texture::Texture(const TextureOptions& options)
    : options_(options),
      wave_(2 * std::numbers::pi / options.period * options.along.stableNormalized()) {}

Texture::Place Texture::at(const Vec3& point) const noexcept {
  const double half = options_.height / 2;
  if (options_.relief == Relief::kGrating) {
    const double phase = wave_.dot(point);
    return {half * (std::cos(phase) - 1), -half * std::sin(phase) * wave_};
  }
  // Beyond these cells doubles no longer tell places apart.
  const Vec3 cells = point / options_.period;
  if (!(cells.cwiseAbs().maxCoeff() < 0x1p50)) return {-half, Vec3::Zero()};
  const Place noise = noise_at(cells);
  return {half * (noise.height - 1), half / options_.period * noise.slope};
}

double Texture::steepest() const {
  const double half = options_.height / 2;
  return options_.relief == Relief::kGrating ? half * wave_.norm()
                                             : half * kNoiseSlope / options_.period;
}

}  // namespace gliss
