#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "gliss/files/atomic_file.h"
#include "gliss/query/query.h"
#include "gliss/results/sweep_files.h"
#include "gliss/surface/names.h"
#include "gliss/tables/vtp_file.h"

namespace gliss {

SweepPicture::SweepPicture(const PatchCache& cache, const SweepOptions& sweep, double unit)
    : cache_(cache),
      sweep_(sweep),
      length_(cache.unit, unit),
      stride_((sample_count(cache, sweep.rings) + kMostPoints - 1) / kMostPoints),
      forces_(sweep.methods.size()),
      seen_(sweep.methods.size(), 0) {}

void SweepPicture::add(const SweepBlock& block) {
  if (block.depth_index != 0) return;
  for (std::size_t i = 0; i < block.hip.size(); ++i) {
    if (seen_[block.method_index]++ % stride_ != 0) continue;
    if (block.method_index == 0) hips_.push_back(length_(block.hip[i]));
    for (const double f : block.force[i]) {
      forces_[block.method_index].push_back(static_cast<float>(f));
    }
  }
}

void SweepPicture::write(const std::string& path) const {
  VtpData data;
  data.points = packed(hips_);
  for (std::size_t m = 0; m < forces_.size(); ++m) {
    data.point_data.push_back({fmt::format("force_{}", method_name(sweep_.methods[m])), 3,
                               std::span<const float>(forces_[m])});
  }
  write_vtp(path, data);
  write_mesh(mesh_path(path));
}

std::string SweepPicture::mesh_path(const std::string& path) {
  return with_ending(path.substr(0, path.size() - kEnding.size()), "_mesh.vtp");
}

// From the patches, whose corners are the polygons': a cache has no other mesh.
void SweepPicture::write_mesh(const std::string& path) const {
  std::vector<Vec3> positions;
  std::vector<std::uint32_t> face_begin{0}, faces, folded;
  std::vector<double> rho_min;
  for (std::uint32_t face = 0; face < cache_.mesh_face_count; ++face) {
    if (cache_.first_patch(face) == kNone) continue;
    const std::uint32_t n = cache_.face_valence[face];
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / n;
      const DomainPoint corner{face, std::cos(angle), std::sin(angle)};
      positions.push_back(length_(evaluate(cache_, corner).position));
    }
    face_begin.push_back(static_cast<std::uint32_t>(positions.size()));
    faces.push_back(face);
    folded.push_back(cache_.folded[cache_.first_patch(face)]);
    rho_min.push_back(length_(cache_.rho_min[cache_.first_patch(face)]));
  }
  std::vector<std::uint32_t> corners(positions.size());
  std::iota(corners.begin(), corners.end(), 0u);
  VtpData data;
  data.points = packed(positions);
  data.face_begin = face_begin;
  data.corner_vertex = corners;
  data.cell_data = {{"face", 1, std::span<const std::uint32_t>(faces)},
                    {"patch", 1, std::span<const std::uint32_t>(faces)},  // the old name
                    {"folded", 1, std::span<const std::uint32_t>(folded)},
                    {"rho_min", 1, std::span<const double>(rho_min)}};
  write_vtp(path, data);
}

}  // namespace gliss
