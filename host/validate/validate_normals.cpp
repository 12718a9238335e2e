// Normals from a file: unit length at every corner in the end, and warnings of odd ones.
#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "gliss/mesh/creases.h"
#include "gliss/validate/validate_steps.h"

namespace gliss {
namespace {

constexpr double kZeroLength = 1e-30;
constexpr double kUnitTolerance = 1e-5;   // what files of six digits need
constexpr double kSharpTolerance = 1e-5;  // rad, below it two normals are one, printed twice

// [normal], the first face that has it at a corner.
std::vector<std::uint32_t> first_faces(const Mesh& mesh) {
  std::vector<std::uint32_t> first(mesh.normals.size(), kNone);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t normal = mesh.corner_normal[c];
      if (normal != kNone && first[normal] == kNone) first[normal] = face;
    }
  }
  return first;
}

// Normals of no length become z: the corners that use them are given others.
std::vector<bool> normalise(Mesh& mesh, Report& report) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const std::vector<std::uint32_t> face = first_faces(mesh);
  std::vector<bool> zero(mesh.normals.size(), false);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    Vec3& normal = mesh.normals[i];
    const double length = normal.stableNorm();
    if (length < kZeroLength) {
      report.add(Severity::kRepaired, "zero-normal", {.face = face[i]}, "normal {} has no length",
                 i);
      zero[i] = true;
      normal = Vec3::UnitZ();
    } else if (std::abs(length - 1) > kRounding) {
      if (std::abs(length - 1) > kUnitTolerance) {
        report.add(Severity::kRepaired, "non-unit-normal", {.face = face[i]},
                   "normal {} has length {:.6g}", i, length);
      }
      normal.stableNormalize();
    }
  }
  return zero;
}

void complete(Mesh& mesh, const std::vector<bool>& zero, Report& report) {
  std::vector<Vec3> computed;                                // [vertex], once needed
  std::unordered_map<std::uint32_t, std::uint32_t> replace;  // [vertex], its new normal
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    bool missing = false;
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      std::uint32_t& normal = mesh.corner_normal[c];
      missing = missing || normal == kNone;
      if (normal != kNone && (normal >= zero.size() || !zero[normal])) continue;
      if (computed.empty()) computed = vertex_normals(mesh);
      const std::uint32_t vertex = mesh.corner_vertex[c];
      const auto next = static_cast<std::uint32_t>(mesh.normals.size());
      const auto [known, is_new] = replace.try_emplace(vertex, next);
      if (is_new) mesh.normals.push_back(computed[vertex]);
      normal = known->second;
    }
    if (missing) {
      report.add(Severity::kRepaired, "missing-normal", {.face = face},
                 "has corners without a normal");
    }
  }
}

void warn_of_backward_normals(const Mesh& mesh, Report& report) {
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    const Vec3 face_normal = newell_normal(mesh, face);
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t vertex = mesh.corner_vertex[c];
      if (mesh.normals[mesh.corner_normal[c]].dot(face_normal) < 0) {
        report.add(Severity::kWarning, "normals-against-face", {.face = face, .vertex = vertex},
                   "the normal at vertex {} points to its back", vertex);
      }
    }
  }
}

// True if each face has one normal, its own, and the faces at nearly every vertex lie in three
// planes or more: facets, as programs write them that know nothing of smooth surfaces. A part of
// flat sides that are divided has vertices within its sides and edges, and has no facets.
bool has_facets(const Mesh& mesh, Report& report) {
  constexpr double kOwn = 0.97, kPlane = 0.9998, kShare = 0.9;  // cosines; share of the vertices
  std::vector<Vec3> own(mesh.face_count());
  std::vector<std::vector<std::uint32_t>> planes(mesh.positions.size());  // a face of each, 3 at
                                                                          // most
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    own[face] = newell_normal(mesh, face).normalized();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      const std::uint32_t normal = mesh.corner_normal[c];
      if (normal == kNone || !(mesh.normals[normal].normalized().dot(own[face]) > kOwn))
        return false;
      auto& at = planes[mesh.corner_vertex[c]];
      const auto is_new = [&](std::uint32_t known) { return own[known].dot(own[face]) < kPlane; };
      if (at.size() < 3 && std::all_of(at.begin(), at.end(), is_new)) at.push_back(face);
      const std::uint32_t first = mesh.corner_normal[mesh.face_begin[face]];
      if ((mesh.normals[normal] - mesh.normals[first]).norm() > kSharpTolerance) return false;
    }
  }
  const auto used =
      std::count_if(planes.begin(), planes.end(), [](const auto& faces) { return !faces.empty(); });
  const auto turned = std::count_if(planes.begin(), planes.end(),
                                    [](const auto& faces) { return faces.size() > 2; });
  return static_cast<double>(turned) >= kShare * static_cast<double>(used);
}

}  // namespace

void repair_normals(Mesh& mesh, NormalSource source, Report& report) {
  if (mesh.normals.empty()) return;
  const bool facets = source == NormalSource::kAuto && has_facets(mesh, report);
  if (facets) {
    report.add(Severity::kRepaired, "facet-normals", {},
               "each face has its own normal, and every edge is sharp by them: normals are made "
               "anew ('--normals file' keeps them)");
  }
  if (facets || source == NormalSource::kMade) {
    mesh.normals.clear();
    mesh.corner_normal.clear();
    return;
  }
  const std::vector<bool> zero = normalise(mesh, report);
  complete(mesh, zero, report);
  warn_of_backward_normals(mesh, report);
}

void mark_creases(Mesh& mesh, const Topology& topology, const CreaseRules& rules,
                  std::span<const std::uint32_t> sides, Report& report) {
  report.poll();
  mark_creases(mesh, topology, rules, sides);
  if (mesh.normals.empty()) return;
  const std::vector<std::uint32_t> group =
      mesh.sharp.empty() ? mesh.corner_vertex : sharp_corners(mesh, topology).corner_normal;
  std::vector<std::uint32_t> first;  // [group], a normal there
  std::vector<bool> sharp(mesh.positions.size(), false);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    report.poll();
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      if (group[c] >= first.size()) first.resize(group[c] + 1, kNone);
      std::uint32_t& known = first[group[c]];
      if (known == kNone) known = mesh.corner_normal[c];
      const double apart = (mesh.normals[mesh.corner_normal[c]] - mesh.normals[known]).norm();
      const std::uint32_t vertex = mesh.corner_vertex[c];
      if (!(apart > kSharpTolerance) || sharp[vertex]) continue;
      sharp[vertex] = true;
      report.add(Severity::kWarning, "sharp-normals", {.face = face, .vertex = vertex},
                 "has another normal at vertex {} than a neighbour", vertex);
    }
  }
}

}  // namespace gliss
