// Meshes made by formula, with their exact surfaces where those exist: nothing needs a file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/mesh/mesh.h"

namespace gliss {

// The surface that a generated mesh approximates, with its exact nearest point.
class GLISS_EXPORT ExactSurface {
 public:
  // In the mesh's unit.
  struct Point {
    Vec3 position;    // nearest point of the surface
    Vec3 normal;      // outward unit normal there
    double distance;  // signed, negative inside
  };
  virtual ~ExactSurface() = default;
  virtual Point nearest(const Vec3& point) const = 0;
};

struct Generated {
  Mesh mesh;                                  // with exact vertex normals where they exist
  std::shared_ptr<const ExactSurface> exact;  // null where there is none
};

// All lengths below are in millimetres, as the meshes that these make (mesh.unit = 1e-3).

// Tube round the (2, 3) torus knot: curve ((R + r cos 3t) cos 2t, (R + r cos 3t) sin 2t, r sin 3t),
// cut into `along` x `around` quads. The defaults give the paper's 1,440 quadrangles.
GLISS_EXPORT Generated torus_knot(int along = 120, int around = 12, double R = 33, double r = 17,
                                  double tube = 12);
// A path of HIPs `depth` (mm) beneath its exact surface, `step` (mm) a tick: over the quads once
// along the knot and once round its tube, back to the first.
GLISS_EXPORT std::vector<Vec3> path_beneath(const Generated& knot, int along, int around,
                                            double depth, double step);
GLISS_EXPORT Generated torus(int along = 24, int around = 12, double R = 30, double r = 10);
// Dual of an icosphere: 12 pentagons and 10 (frequency^2 - 1) hexagons, vertices on the sphere.
GLISS_EXPORT Generated goldberg(int frequency = 4, double radius = 10);
// Balls as of goldberg() round one centre, without normals. One whose radius is below 0 is wound
// inward: in a ball of more it is a cavity, alone a room.
GLISS_EXPORT Generated nested_balls(const std::vector<double>& radii, int frequency = 4);
// goldberg(), stretched to an ellipsoid of this length, width and height (in x, y, z).
GLISS_EXPORT Generated ellipsoid(int frequency = 4, double length = 40, double width = 24,
                                 double height = 16);
// Quads and two end caps.
GLISS_EXPORT Generated banana(int along = 37, int around = 11);
// n-gon caps, n up to 1000.
GLISS_EXPORT Generated prism(int sides = 6, double radius = 10, double height = 10);
// A cube of `cells` x `cells` squares a side, and a cylinder of quads, `around` x `along`, with
// n-gon caps: both with the normals of their faces, which differ across their edges and rims.
GLISS_EXPORT Generated cube(int cells = 1, double size = 10);
GLISS_EXPORT Generated cylinder(int around = 24, int along = 2, double radius = 10,
                                double height = 20);
// A closed box, width x width, of nx x ny quads at top and bottom.
GLISS_EXPORT Generated thin_plate(int nx = 12, int ny = 12, double width = 30,
                                  double thickness = 0.5);
// A closed wedge with a sharp ridge.
GLISS_EXPORT Generated fin(int along = 16, double height = 15, double base = 4, double length = 30);

// Triangles between random points of a shape's exact surface, as many as the shape has vertices, of
// all valences: like those of a scanned mesh. They are Delaunay triangles where the surface lets
// them be. With exact vertex normals. Vertices of sharp edges, where the normals of faces differ,
// stay, and so do faces that have no others, such as the caps of a cylinder. The same for a seed
// everywhere. Throws std::invalid_argument for a shape without an exact surface or normals, with
// sharp edges elsewhere than round such faces, or with no other face.
GLISS_EXPORT Generated irregular(Generated shape, std::uint64_t seed);

}  // namespace gliss
