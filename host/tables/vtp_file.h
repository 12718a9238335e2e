// Surfaces and points for ParaView: VTK XML PolyData (.vtp) with raw appended data.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"

namespace gliss {

using VtpValues =
    std::variant<std::span<const double>, std::span<const float>, std::span<const std::uint32_t>>;

struct VtpArray {
  std::string name;    // as ParaView shows it
  int components = 1;  // 1 or 3 (packed triples)
  VtpValues values;    // of every point, or of every cell
};

// All spans must outlive the call.
struct VtpData {
  VtpValues points = {};  // packed triples, double or float
  // Polygons as in Mesh; both empty: one vertex cell a point.
  std::span<const std::uint32_t> face_begin = {};
  std::span<const std::uint32_t> corner_vertex = {};
  std::vector<VtpArray> point_data = {};
  std::vector<VtpArray> cell_data = {};
};

inline std::span<const double> packed(std::span<const Vec3> vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return {vectors.empty() ? nullptr : vectors.front().data(), 3 * vectors.size()};
}

// Atomically. Throws std::system_error where the file cannot be written, std::logic_error where
// sizes do not fit.
GLISS_EXPORT void write_vtp(const std::string& path, const VtpData& data);

}  // namespace gliss
