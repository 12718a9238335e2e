#include "tools/view/view_geometry.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "gliss/build/cache_mesh.h"
#include "gliss/mesh/topology.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/query/query.h"
#include "gliss/sweep/surface_picture.h"
#include "tools/view/bytes.h"

namespace gliss::tools {
namespace {

// Triangles over a regular n-gon: a fan of n sectors, each with `rings` rows; without rings of the
// corners alone.
struct Fan {
  std::vector<std::array<double, 2>> points;  // xi, eta: the middle, then ring after ring
  std::vector<std::uint32_t> triangles;

  Fan(std::uint32_t n, std::uint32_t rings) {
    if (rings == 0) {
      take_corners(n);
    } else {
      take_rings(n, rings);
    }
  }

 private:
  void take_rings(std::uint32_t n, std::uint32_t rings) {
    points.push_back({0, 0});
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
      for (std::uint32_t side = 0; side < n; ++side) {
        for (std::uint32_t i = 0; i < ring; ++i) {
          const double share = static_cast<double>(ring) / rings;
          const DomainPoint edge = on_side(0, n, side, static_cast<double>(i) / ring);
          points.push_back({share * edge.xi, share * edge.eta});
        }
      }
    }
    // The i-th point of a ring from the first corner on, n * ring of them.
    const auto at = [&](std::uint32_t ring, std::uint32_t i) {
      return ring == 0 ? 0 : 1 + n * ring * (ring - 1) / 2 + i % (n * ring);
    };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      triangles.insert(triangles.end(), {a, b, c});
    };
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
      for (std::uint32_t side = 0; side < n; ++side) {
        for (std::uint32_t i = 0; i < ring; ++i) {
          const std::uint32_t outer = side * ring + i, inner = side * (ring - 1) + i;
          add(at(ring - 1, inner), at(ring, outer), at(ring, outer + 1));
          if (i + 1 < ring) add(at(ring - 1, inner), at(ring, outer + 1), at(ring - 1, inner + 1));
        }
      }
    }
  }

  void take_corners(std::uint32_t n) {
    for (std::uint32_t side = 0; side < n; ++side) {
      const DomainPoint corner = on_side(0, n, side, 0);
      points.push_back({corner.xi, corner.eta});
      if (side >= 2) triangles.insert(triangles.end(), {0, side - 1, side});
    }
  }
};

// Returns the rings of all faces, so that there are no more triangles than that where a face can do
// with its corners.
std::uint32_t rings_of(const PatchCache& cache, std::size_t triangles) {
  std::size_t sides = 0;
  for (const std::uint32_t n : cache.face_valence) sides += n;
  const double each =
      static_cast<double>(triangles) / static_cast<double>(std::max<std::size_t>(sides, 1));
  return static_cast<std::uint32_t>(std::clamp(std::sqrt(each), 0.0, 8.0));
}

// An object's surface at the points of a fan over each face.
struct Samples {
  std::vector<DomainPoint> where;
  std::vector<SurfacePoint> points;      // [where]
  std::vector<std::uint32_t> triangles;  // 3 of `where` each
};

Samples samples_of(const PatchCache& cache, std::size_t most) {
  const std::uint32_t rings = rings_of(cache, most);
  std::map<std::uint32_t, Fan> fans;
  Samples samples;
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    const std::uint32_t n = cache.face_valence[face];
    const Fan& fan = fans.try_emplace(n, n, rings).first->second;
    const auto first = static_cast<std::uint32_t>(samples.where.size());
    for (const auto& [xi, eta] : fan.points) samples.where.push_back({face, xi, eta});
    for (const std::uint32_t i : fan.triangles) samples.triangles.push_back(first + i);
  }
  samples.points.resize(samples.where.size());
  evaluate(cache, samples.where, samples.points);
  return samples;
}

// A message under construction: parts of one object.
class Packer {
 public:
  explicit Packer(const SceneObject& object)
      : object_(object), cache_(*object.cache), mesh_(mesh_of(cache_)) {}

  std::string pack(std::uint32_t number, std::size_t most) {
    const Samples samples = samples_of(cache_, most);
    add_points(samples);
    add_edges();
    const std::vector<Vec3> corners = triangles_of(mesh_);
    for (const Vec3& corner : corners) append_floats(polygons_, place(corner));
    const std::uint32_t faces = add_faces();
    std::string bytes;
    for (const std::size_t head :
         {std::size_t{kGeometryMark}, std::size_t{number}, samples.points.size(),
          samples.triangles.size() / 3, edge_count_, corners.size() / 3, std::size_t{faces},
          mesh_.corner_vertex.size()})
      append_bytes(bytes, static_cast<std::uint32_t>(head));
    for (const std::string* part : {&positions_, &normals_, &heights_, &faces_}) bytes += *part;
    for (const std::uint32_t i : samples.triangles) append_bytes(bytes, i);
    for (const std::string* part : {&edges_, &polygons_, &curvatures_, &firsts_, &neighbours_})
      bytes += *part;
    return bytes;
  }

 private:
  Vec3 place(const Vec3& p) const { return object_.pose * (p * cache_.unit); }

  // Returns 4, crease, for an exact patch with a sharp side; else its PatchKind.
  std::uint8_t kind_of(std::uint32_t face) const {
    const auto kind = static_cast<std::uint8_t>(cache_.kind[cache_.first_patch(face)]);
    if (kind > 0 || mesh_.sharp.empty()) return kind;
    const auto begin = mesh_.sharp.begin() + mesh_.face_begin[face];
    const bool is_sharp = std::any_of(begin, begin + mesh_.valence(face), [](auto s) { return s; });
    return is_sharp ? 4 : 0;
  }

  void add_points(const Samples& samples) {
    Vec3 middle = Vec3::Zero(), up = Vec3::Zero();
    std::uint32_t last = kNone;
    std::uint8_t kind = 0;
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
      const auto& [position, d_xi, d_eta, own] = samples.points[i];
      const std::uint32_t face = samples.where[i].face;
      if (face != last) {
        last = face;
        kind = kind_of(face);
        up = newell_normal(mesh_, face).normalized();
        middle.setZero();
        const std::uint32_t n = mesh_.valence(face);
        for (std::uint32_t c = 0; c < n; ++c)
          middle += mesh_.positions[mesh_.corner_vertex[mesh_.face_begin[face] + c]] / n;
      }
      append_floats(positions_, place(position));
      const Vec3 normal = object_.pose.linear() * own;
      for (int axis = 0; axis < 3; ++axis)
        append_bytes(normals_, static_cast<std::int8_t>(std::lround(127 * normal[axis])));
      append_bytes(normals_, kind);
      append_bytes(heights_, static_cast<float>((position - middle).dot(up) * cache_.unit));
      append_bytes(faces_, face);
    }
  }

  void add_edges() {
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      const std::uint32_t begin = mesh_.face_begin[f], n = mesh_.valence(f);
      for (std::uint32_t i = 0; i < n; ++i) {
        if (topology_.side_twin[begin + i] < begin + i) continue;  // the face across has it
        for (const std::uint32_t corner : {begin + i, begin + (i + 1) % n})
          append_floats(edges_, place(mesh_.positions[mesh_.corner_vertex[corner]]));
        ++edge_count_;
      }
    }
  }

  std::uint32_t add_faces() {
    const std::vector<double> curvatures = face_curvatures(cache_);
    const auto faces = static_cast<std::uint32_t>(mesh_.face_count());
    for (std::uint32_t f = 0; f < faces; ++f) {
      const double own = curvatures[f] / cache_.unit;
      append_bytes(curvatures_, std::isnan(own) ? 0.0F : static_cast<float>(own));
      append_bytes(firsts_, mesh_.face_begin[f]);
    }
    for (const std::uint32_t twin : topology_.side_twin)
      append_bytes(neighbours_, twin == kNone ? kNone : topology_.side_face[twin]);
    return faces;
  }

  const SceneObject& object_;
  const PatchCache& cache_;
  const Mesh mesh_;
  const Topology topology_ = build_topology(mesh_);
  std::string positions_, normals_, heights_, faces_;  // of points
  std::string edges_, polygons_;
  std::string curvatures_, firsts_, neighbours_;  // of faces, and of their sides
  std::size_t edge_count_ = 0;
};

}  // namespace

std::string geometry_of(const SceneObject& object, std::uint32_t number, std::size_t triangles) {
  return Packer(object).pack(number, triangles);
}

}  // namespace gliss::tools
