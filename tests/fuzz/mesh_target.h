// Whatever the text of a mesh file: a mesh that keeps the promises of host/mesh/mesh.h, or a
// MeshError with a finding that says why.
#pragma once

#include "gliss/files/mesh_readers.h"
#include "gliss/validate/validate.h"
#include "gliss/validate/validate_steps.h"
#include "tests/fuzz/fuzz.h"

namespace gliss::fuzz {

inline void require_sound(const Mesh& mesh) {
  const auto finite = [](const Vec3& v) { return v.allFinite(); };
  require(std::all_of(mesh.positions.begin(), mesh.positions.end(), finite), "finite positions");
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    require(mesh.valence(face) >= 3 && mesh.valence(face) <= kMaxValence, "3 to 1000 sides");
  }
  for (const std::uint32_t vertex : mesh.corner_vertex)
    require(vertex < mesh.positions.size(), "vertices that there are");
  for (const std::uint32_t normal : mesh.corner_normal)
    require(normal < mesh.normals.size(), "normals that there are");
  for (const Vec3& normal : mesh.normals)
    require(std::abs(normal.norm() - 1) < 2e-5, "unit normals");
}

// True where it is sound, and then it is sound as it stands.
inline bool validated(Mesh& mesh, const LoadOptions& options, Report& report) {
  try {
    validate(mesh, options, report);
  } catch (const MeshError&) {
    return false;
  }
  require_sound(mesh);
  validate(mesh);
  return true;
}

inline int read_mesh(void (*read)(std::string_view, Mesh&, Report&), std::string_view text) {
  for (const bool strict : {false, true}) {
    Mesh mesh;
    mesh.source = "fuzz";
    std::vector<Finding> findings;
    Report report(mesh, &findings, nullptr, strict);
    try {
      read(text, mesh, report);
    } catch (const MeshError&) {
      const auto is_error = [](const Finding& finding) {
        return finding.severity == Severity::kError;
      };
      require(std::any_of(findings.begin(), findings.end(), is_error), "a finding that says why");
      return 0;
    }
    validated(mesh, {.strict = strict, .weld = strict ? -1 : 0.25}, report);
  }
  return 0;
}

}  // namespace gliss::fuzz
