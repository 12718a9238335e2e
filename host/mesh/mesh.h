// A polygon mesh as flat arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"

namespace gliss {

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
  // [face], smoothing group of an OBJ file, 0: none; empty: it names none
  std::vector<std::uint32_t> face_group;
  // Creases (creases.h). [side], 1: its edge is one; empty: there are none. Made after `validate`.
  std::vector<std::uint8_t> sharp;
  // [side][2], what add_vertex_normals leaves besides normals where there are creases, and
  // round_creases where there were: C'(0) and C'(1) of the curve that both faces at an edge share;
  // (0, 0, 0): as the normals ask.
  std::vector<Vec3> tangents;
  // [face], how far its patch should leave its polygon at most (complete_mesh.h); empty: any way.
  std::vector<double> most_sag;
  // Faces that round_creases (rounding.h) added behind all others, in this order: the strips, two
  // for each crease, with the vertices of its edge, and the corners, with the vertex that they took
  // the place of.
  std::vector<std::array<std::uint32_t, 2>> strips;
  std::vector<std::uint32_t> rounded_corners;
  // Faces of the file that `validate` removed, by their numbers there, ascending; those behind them
  // have moved up.
  std::vector<std::uint32_t> lost_faces;
  double unit = 1.0;   // metres per unit of length
  std::string source;  // file name for messages

  std::size_t face_count() const { return face_begin.size() - 1; }
  std::uint32_t valence(std::size_t face) const { return face_begin[face + 1] - face_begin[face]; }
  // True if a side's edge is a crease.
  bool is_crease(std::size_t side) const { return !sharp.empty() && sharp[side] != 0; }
  // True if a side has `tangents` of its own.
  bool has_tangents(std::size_t side) const {
    return !tangents.empty() && !tangents[2 * side].isZero(0);
  }
};

// A mesh that cannot be used; what() names file, line, face or edge.
struct GLISS_EXPORT MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The box of a face, and of all faces, of which there are some.
GLISS_EXPORT Box box_of(const Mesh& mesh, std::size_t face);
GLISS_EXPORT Box box_of(const Mesh& mesh);

// XXH3 of the mesh's unit, positions, normals, faces with their corners, and sharp sides. Tangents,
// groups and strips are left out.
GLISS_EXPORT std::uint64_t hash_of(const Mesh& mesh);

}  // namespace gliss
