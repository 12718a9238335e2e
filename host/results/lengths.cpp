#include "gliss/results/lengths.h"

#include <fmt/format.h>

#include <stdexcept>

#include "gliss/base/units.h"

namespace gliss {

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

}  // namespace gliss
