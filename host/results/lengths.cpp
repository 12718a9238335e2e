#include "gliss/results/lengths.h"

#include <fmt/format.h>

#include <stdexcept>

#include "gliss/base/units.h"

namespace gliss {
namespace {

// The share of the faces that have patches.
double share_of_tight_faces(const PatchCache& cache, double depth) {
  std::size_t faces = 0, tight = 0;
  for (std::size_t patch = 0; patch < cache.patch_face.size();) {
    const std::uint32_t face = cache.patch_face[patch];
    bool is_tight = false;
    for (; patch < cache.patch_face.size() && cache.patch_face[patch] == face; ++patch)
      is_tight = is_tight || cache.rho_min[patch] * cache.unit < depth;
    ++faces;
    tight += is_tight;
  }
  return faces == 0 ? 0 : static_cast<double>(tight) / static_cast<double>(faces);
}

}  // namespace

std::string unit_name(double unit) {
  for (const char* name : {"m", "cm", "mm", "um", "nm", "in"}) {
    if (unit == parse_unit(name)) return name;
  }
  return fmt::format("{} m", unit);
}

std::string length_text(double metres) {
  if (metres >= 1) return fmt::format("{:.3g} m", metres);
  if (metres >= 1e-3) return fmt::format("{:.3g} mm", metres * 1e3);
  return fmt::format("{:.3g} um", metres * 1e6);
}

double diagonal_of(const Box& box) { return (box.high - box.low).norm(); }

void check_depths(const std::string& option, std::span<const double> depths,
                  const PatchCache& cache) {
  const double across = diagonal_of(cache.bounds()) * cache.unit;
  for (const double depth : depths) {
    if (depth <= across) continue;
    throw std::invalid_argument(
        fmt::format("{}: a depth of {} is more than the {} that the surface is across; a bare "
                    "number is metres, and '2mm' is two millimetres",
                    option, length_text(depth), length_text(across)));
  }
}

double usual_depth(const PatchCache& cache) {
  return 0.005 * diagonal_of(cache.bounds()) * cache.unit;
}

std::string tight_curvature_text(const PatchCache& cache, double depth,
                                 const std::string& meaning) {
  const double percent = 100 * share_of_tight_faces(cache, depth);
  if (percent == 0) return "";
  const std::string share =
      percent < 10 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent);
  const std::string in_brackets = meaning.empty() ? "" : fmt::format(" ({})", meaning);
  return fmt::format(
      "{} % of the faces have a radius of curvature below {:.3g} mm{}: expect jumps there", share,
      depth * 1e3, in_brackets);
}

}  // namespace gliss
