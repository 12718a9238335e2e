// A mesh whose sides may be arcs, as it is built: one normal a vertex, tangents of its sides.
// Private to host/.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gliss/mesh/mesh.h"

namespace gliss {

class ArcMesh {
 public:
  // Its vertices have positions and unit normals; the other arrays are made by finish, but for
  // strips and rounded_corners.
  Mesh mesh;

  // Return the number of the vertex.
  std::uint32_t add_vertex(const Vec3& position, const Vec3& normal);
  // The middle of the arc between two vertices, and the arcs on both sides of it.
  std::uint32_t add_middle(std::uint32_t a, std::uint32_t b, const Vec3& first = Vec3::Zero(),
                           const Vec3& last = Vec3::Zero());
  // The centre of a ring of vertices and the middles of the arcs between, in turn.
  std::uint32_t add_centre(std::span<const std::uint32_t> ring);

  // An arc from vertex a to b, once for both directions. It has these directions at its ends where
  // they are not zero, but leans a little to what the normals ask: a polygon whose sides went
  // straight on over a corner would have no normal there.
  void add_arc(std::uint32_t a, std::uint32_t b, const Vec3& first = Vec3::Zero(),
               const Vec3& last = Vec3::Zero());

  // `line`: of the file, 0 if there is none.
  void add_face(std::span<const std::uint32_t> vertices, std::uint32_t line);

  // The mesh; nothing is left.
  Mesh finish();

 private:
  struct Arc {
    std::array<std::uint32_t, 2> ends;
    Vec3 start, end;  // C'(0) and C'(1)
  };

  Arc arc_of(std::uint32_t a, std::uint32_t b, const Vec3& first, const Vec3& last) const;

  std::vector<Arc> arcs_;
};

}  // namespace gliss
