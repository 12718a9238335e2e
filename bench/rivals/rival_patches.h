// Surfaces that others make from the same corners and normals, and nearest points of them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gliss/mesh/mesh.h"

namespace gliss::rivals {

enum class Rival {
  kFlat,   // the polygons, cut into triangles
  kPhong,  // Phong tessellation (Boubekeur and Alexa 2008) with their alpha, 3/4
  kPn,     // curved PN triangles (Vlachos, Peters, Boyd and Mitchell 2001): their cubic geometry
  kNagata  // quadratic patches of three or four sides (Nagata 2005)
};

using Vec2 = Eigen::Vector2d;

// Each of these is a polynomial of degree 3 at most, of u and v in a triangle (0, 0), (1, 0),
// (0, 1) or in the unit square.
struct RivalPatch {
  struct Jet {
    Vec3 at, u, v, uu, uv, vv;  // the point and its derivatives
    Vec3 normal() const { return u.cross(v).normalized(); }
  };
  Eigen::Matrix<double, 3, 10> terms;  // of 1, u, v, uu, uv, vv, uuu, uuv, uvv, vvv
  bool is_square = false;

  Vec3 at(const Vec2& x) const;
  Jet jet(const Vec2& x) const;
};

// A triangle of a domain that is cut into them, `rows` along a side.
struct Piece {
  std::array<Vec2, 3> corners;
  Vec2 middle;
  double area;
};
std::vector<Piece> pieces(int rows, bool is_square);

struct RivalFoot {
  Vec3 point = Vec3::Zero();
  double distance = 0;  // 0 or more
};

class RivalSurface {
 public:
  // Every vertex of the mesh has a normal. Polygons of more sides than a rival takes are cut into
  // triangles.
  RivalSurface(Rival rival, const Mesh& mesh);

  const std::vector<RivalPatch>& patches() const { return patches_; }
  // The nearest points of places, of all the surface. Those that follow each other are best near
  // each other.
  std::vector<RivalFoot> nearest(std::span<const Vec3> places) const;

 private:
  // A piece of a patch, which lies within a sphere.
  struct Cell {
    std::size_t patch;
    Vec2 middle;
    Vec3 centre;
    double radius;
  };
  std::vector<RivalPatch> patches_;
  std::vector<Cell> cells_;
};

}  // namespace gliss::rivals
