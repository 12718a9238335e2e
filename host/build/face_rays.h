// Looks from faces along their normals, and finds what lies opposite. Private to host/.
#pragma once

#include <cstdint>
#include <vector>

#include "gliss/base/large_array.h"
#include "gliss/base/parallel.h"
#include "gliss/mesh/mesh.h"
#include "gliss/surface/base_triangles.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {

// Does not change: any number of threads may ask.
class FaceRays {
 public:
  // The polygons of a validated mesh, cut into triangles, or those of a cache.
  explicit FaceRays(const Mesh& mesh, const ParallelFor& parallel = serial_for);
  explicit FaceRays(const PatchCache& cache, const ParallelFor& parallel = serial_for);

  // The room of a face: the least way from the middles of its triangles, along or against their
  // normals, to another face that lies across (within 60 degrees): how thick the solid is there, or
  // how wide the gap. Infinity where there is none within `reach`. Both in the mesh's unit.
  double room(std::uint32_t face, double reach) const;

 private:
  struct Triangle {
    Vec3 start, ahead, back;  // its first corner, and from there to the others; scaled
  };
  void add(const BaseTriangle& triangle, Box& face);
  void end_face() { first_.push_back(static_cast<std::uint32_t>(triangles_.size())); }
  // The way along or against a direction to the next other face, at most `reach`, else infinity.
  // Scaled; direction of unit length.
  double hit(const Vec3& from, const Vec3& direction, std::uint32_t face, double reach) const;

  double scale_ = 1;
  std::vector<Triangle> triangles_;      // face by face
  std::vector<std::uint32_t> first_{0};  // [face + 1], of the triangles
  LargeArray<double> node_;              // of hierarchy.h, over the faces
  LargeArray<std::uint32_t> child_;
};

}  // namespace gliss
