// A polygon mesh as flat arrays, and the errors and findings that every reader and check reports.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace gliss {

using Vec3 = Eigen::Vector3d;
// Eigen never aligns it, whatever the flags of a library and its user.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && alignof(Vec3) == alignof(double));

inline constexpr std::uint32_t kNone = 0xFFFFFFFFu;
inline constexpr std::size_t kMaxValence = 1000;
inline constexpr double kMostCoordinate = 1e60;  // beyond, areas and volumes would overflow
inline constexpr double kLeastUnit = 1e-15, kMostUnit = 1e15;  // metres

// Faces laid end to end. A corner is one entry of corner_vertex; the side of the same index runs
// from that corner to the next one of its face. Invariants once `validate` has passed: every face
// has 3 to kMaxValence corners, every index is in range, every number is finite.
struct Mesh {
  std::vector<Vec3> positions;               // [vertex], in `unit`
  std::vector<Vec3> normals;                 // [normal], unit length; empty: the file had none
  std::vector<std::uint32_t> face_begin{0};  // [face + 1], first corner of each face
  std::vector<std::uint32_t> corner_vertex;  // [corner], anticlockwise seen from outside
  std::vector<std::uint32_t> corner_normal;  // [corner], into normals; empty when normals is
  std::vector<std::uint32_t> face_line;      // [face], line of the source file; empty: generated
  double unit = 1.0;                         // metres per unit of length
  std::string source;                        // file name for messages

  std::size_t face_count() const { return face_begin.size() - 1; }
  std::uint32_t valence(std::size_t face) const { return face_begin[face + 1] - face_begin[face]; }
};

// A mesh that cannot be used; what() names file, line, face or edge.
struct MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class Severity { kError, kRepaired, kWarning };

// One thing that a check found. `code` is stable ("non-manifold-edge"), so that scripts can rely on
// it. face, vertex and line name the first occurrence (kNone / 0: not applicable), count says how
// many. Faces are numbered from 0 as in the file, before any duplicate was removed.
struct Finding {
  std::string code;
  Severity severity = Severity::kWarning;
  std::string message;  // one line, for people; names the place
  std::uint32_t face = kNone;
  std::uint32_t vertex = kNone;
  std::size_t line = 0;
  std::size_t count = 1;
};

struct LoadOptions {
  double unit = 1.0;                // metres per unit of the file
  bool split_non_manifold = false;  // duplicate vertices instead of refusing
  // Asked many times a second, on the thread that reads and checks; what it throws ends that.
  std::function<void()> poll = nullptr;
};

// Reads OBJ, OFF or PLY (by extension), validates and repairs. Pipes and devices are refused, and
// lines of over 16 MiB. No face is dropped in silence: counts are checked against the file. Appends
// what was found to *findings (may be null). Throws MeshError on the first finding of severity
// kError, after all findings are appended.
Mesh load_mesh(const std::string& path, const LoadOptions& options = {},
               std::vector<Finding>* findings = nullptr);

// The checks behind every reader, for meshes made in memory: repairs in place, appends findings,
// throws MeshError where any is of severity kError. mesh.unit stays; a corner_normal of kNone
// (missing) is filled in.
void validate(Mesh& mesh, const LoadOptions& options = {},
              std::vector<Finding>* findings = nullptr);

// Writes OBJ (positions, normals as v//vn, n-gons) with 17 digits, atomically. Throws
// std::system_error.
void save_obj(const Mesh& mesh, const std::string& path, const std::string& comment = "");

}  // namespace gliss
