// Finds what is accepted, but worth a warning.
#include <cmath>
#include <numbers>

#include "gliss/base/hash_index.h"
#include "gliss/mesh/mesh_edges.h"
#include "gliss/mesh/topology.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

constexpr double kReflex = 1e-6;     // sine beyond the straight angle
constexpr double kNonPlanar = 0.05;  // off the plane, of the root of the area

// Why a face is not convex in its plane; null where it is. One without reflex corners can still
// cross itself, as a pentagram does.
const char* concavity(const Mesh& mesh, std::uint32_t face, const Vec3& unit_normal) {
  constexpr double kOneAndAHalf = 3 * std::numbers::pi;  // a whole number of turns it is
  double turn = 0;
  const auto side = [&](std::uint32_t c) -> Vec3 {
    return mesh.positions[mesh.corner_vertex[next_corner(mesh, face, c)]] -
           mesh.positions[mesh.corner_vertex[c]];
  };
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
    const Vec3 in = side(prev_corner(mesh, face, c));
    const Vec3 out = side(c);
    const double sine = in.cross(out).dot(unit_normal);
    if (sine < -kReflex * in.norm() * out.norm()) return "has a reflex corner";
    turn += std::atan2(sine, in.dot(out) - in.dot(unit_normal) * out.dot(unit_normal));
  }
  return turn > kOneAndAHalf ? "crosses itself" : nullptr;
}

// The largest distance of a corner from the plane through the mean of all.
double deviation(const Mesh& mesh, std::uint32_t face, const Vec3& unit_normal) {
  const Vec3& origin = mesh.positions[mesh.corner_vertex[mesh.face_begin[face]]];
  double sum = 0, low = 0, high = 0;
  for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
    const double height = (mesh.positions[mesh.corner_vertex[c]] - origin).dot(unit_normal);
    sum += height;
    low = std::min(low, height);
    high = std::max(high, height);
  }
  const double mean = sum / mesh.valence(face);
  return std::max(high - mean, mean - low);
}

// A vertex that slid over its neighbours: the faces there that lie over others face against the
// mean of all.
void warn_of_folds(const Mesh& mesh, const std::vector<Vec3>& unit_normal, Report& report) {
  const std::vector<Vec3> mean = vertex_normals(mesh);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t vertex = mesh.corner_vertex[c];
      const double along = unit_normal[face].dot(mean[vertex]);
      // The two sides of a sheet have no mean.
      if (!(along < -kReflex && along > kReflex - 1)) continue;
      report.add(Severity::kWarning, "fold", {.face = face, .vertex = vertex},
                 "faces against the mean normal at vertex {}: it lies over its neighbours", vertex);
      break;
    }
  }
}

}  // namespace

void warn_of_vertices(const Mesh& mesh, const std::vector<bool>& joined, Report& report) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const std::uint32_t vertex : mesh.corner_vertex) used[vertex] = true;
  HashIndex known(mesh.positions.size());
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    report.poll();
    if (joined[v]) continue;
    if (!used[v]) {
      report.add(Severity::kWarning, "unused-vertices", {.vertex = v}, "belongs to no face");
      continue;
    }
    const std::uint32_t first = known.find_or_insert(
        v, mix_bits(mesh.positions[v]),
        [&](std::uint32_t a, std::uint32_t b) { return mesh.positions[a] == mesh.positions[b]; });
    if (first != v) {
      report.add(Severity::kWarning, "coincident-vertices", {.vertex = v},
                 "is where vertex {} is; faces do not meet there", first);
    }
  }
}

void warn_of_shapes(const Mesh& mesh, Report& report) {
  std::vector<Vec3> normals;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    const Vec3 normal = newell_normal(mesh, face);
    const double size = normal.norm();
    const Vec3 unit_normal = normal / size;
    normals.push_back(unit_normal);
    if (const char* why = concavity(mesh, face, unit_normal)) {
      report.add(Severity::kWarning, "concave", {.face = face}, "{}", why);
    }
    const double ratio = deviation(mesh, face, unit_normal) / std::sqrt(size / 2);
    if (ratio > kNonPlanar) {
      report.add(Severity::kWarning, "non-planar", {.face = face},
                 "is off its plane by {:.1f} % of the root of its area", 100 * ratio);
    }
  }
  warn_of_folds(mesh, normals, report);
}

}  // namespace gliss
