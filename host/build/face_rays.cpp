#include "gliss/build/face_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "gliss/build/hierarchy.h"
#include "gliss/build/mesh_frame.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/patch_cache.h"

namespace gliss {
namespace {

constexpr double kOpen = std::numeric_limits<double>::infinity();
constexpr double kTouching = 1e-6;  // of half the mesh; faces that near lie on each other
constexpr double kAcross = 0.5;     // cosine

const Box kNothing{Vec3::Constant(kOpen), Vec3::Constant(-kOpen)};

}  // namespace

void FaceRays::add(const BaseTriangle& t, Box& face) {
  triangles_.push_back({t[0], t[1] - t[0], t[2] - t[0]});
  for (const Vec3& corner : t) face.hold(corner);
}

FaceRays::FaceRays(const Mesh& mesh, const ParallelFor& parallel) {
  const Box all = box_of(mesh);
  scale_ = 2 / (all.high - all.low).maxCoeff();
  const MeshFrame frame{mesh, all.low + 0.5 * (all.high - all.low), scale_};
  std::vector<Box> boxes(mesh.face_count(), kNothing);
  const auto place = [&](std::uint32_t c) { return frame.position(c); };
  std::vector<Vec3> t;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    t.clear();
    append_triangles(mesh, face, place, t);
    for (std::size_t i = 0; i < t.size(); i += 3) add({t[i], t[i + 1], t[i + 2]}, boxes[face]);
    end_face();
  }
  build_hierarchy(boxes, node_, child_, parallel);
}

FaceRays::FaceRays(const PatchCache& cache, const ParallelFor& parallel) : scale_(cache.scale) {
  std::vector<Box> boxes(cache.mesh_face_count, kNothing);
  std::visit(
      [&](const auto& s) {
        std::uint32_t patch = 0;
        for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
          for (; patch < cache.patch_count() && cache.patch_face[patch] == face; ++patch)
            for_polygon_triangles(s, patch, [&](const BaseTriangle& t) { add(t, boxes[face]); });
          end_face();
          const bool is_built = first_[face] < first_[face + 1];
          if (!is_built) boxes[face] = {Vec3::Zero(), Vec3::Zero()};
        }
      },
      cache.surface);
  build_hierarchy(boxes, node_, child_, parallel);
}

double FaceRays::room(std::uint32_t face, double reach) const {
  double room = reach * scale_;
  for (std::uint32_t t = first_[face]; t < first_[face + 1]; ++t) {
    const Triangle& from = triangles_[t];
    const Vec3 normal = from.ahead.cross(from.back).stableNormalized();
    if (normal.isZero(0)) continue;
    const Vec3 middle = from.start + (from.ahead + from.back) / 3;
    room = std::min(room, hit(middle, normal, face, room));
  }
  return room < reach * scale_ ? room / scale_ : kOpen;
}

double FaceRays::hit(const Vec3& from, const Vec3& direction, std::uint32_t face,
                     double reach) const {
  double nearest = reach;
  bool is_hit = false;
  const auto meet = [&](const Triangle& t) {  // Moeller and Trumbore 1997
    const Vec3 p = direction.cross(t.back), s = from - t.start, q = s.cross(t.ahead);
    const double det = t.ahead.dot(p), u = s.dot(p) / det, v = direction.dot(q) / det,
                 way = std::abs(t.back.dot(q) / det);
    if (!(u >= 0 && v >= 0 && u + v <= 1 && way > kTouching && way < nearest)) return;
    if (!(std::abs(det) > kAcross * t.ahead.cross(t.back).norm())) return;
    nearest = way;
    is_hit = true;
  };
  const Vec3 inverse = direction.cwiseInverse();
  // Boxes are wider than what they hold (hierarchy.h), so that no ray runs along a face of one.
  const auto is_met = [&](const double* box) {
    double begin = -nearest, end = nearest;
    for (int i = 0; i < 3; ++i) {
      const double low = (box[i] - from[i]) * inverse[i],
                   high = (box[3 + i] - from[i]) * inverse[i];
      begin = std::max(begin, std::min(low, high));
      end = std::min(end, std::max(low, high));
    }
    return begin <= end;
  };
  std::array<std::uint32_t, kHierarchyDepth + 2> open;
  std::size_t left = 0;
  if (!child_.empty()) open[left++] = 0;
  while (left > 0) {
    const std::size_t at = open[--left];
    for (std::size_t place = 2 * at; place < 2 * at + 2; ++place) {
      if (!is_met(&node_[6 * place])) continue;
      if (child_[place] & kNodeLeaf) {
        const std::uint32_t other = child_[place] & ~kNodeLeaf;
        if (other == face) continue;
        for (std::uint32_t t = first_[other]; t < first_[other + 1]; ++t) meet(triangles_[t]);
      } else {
        open[left++] = child_[place];
      }
    }
  }
  return is_hit ? nearest : kOpen;
}

}  // namespace gliss
