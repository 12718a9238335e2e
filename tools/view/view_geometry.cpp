#include "tools/view/view_geometry.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "gliss/build/cache_mesh.h"
#include "gliss/mesh/topology.h"
#include "gliss/mesh/triangulate.h"
#include "gliss/query/query.h"
#include "tools/view/bytes.h"

namespace gliss::tools {
namespace {

// Triangles over a regular n-gon: a fan of n sectors, each with `rings` rows.
struct Fan {
  std::vector<std::array<double, 2>> points;  // xi, eta: the middle, then ring after ring
  std::vector<std::uint32_t> triangles;

  Fan(std::uint32_t n, std::uint32_t rings) {
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
};

// Rings for all faces, so that there are no more triangles than that if one for a side is not.
std::uint32_t rings_of(const PatchCache& cache, std::size_t triangles) {
  std::size_t sides = 0;
  for (const std::uint32_t n : cache.face_valence) sides += n;
  const double each =
      static_cast<double>(triangles) / static_cast<double>(std::max<std::size_t>(sides, 1));
  return static_cast<std::uint32_t>(std::clamp(std::sqrt(each), 1.0, 8.0));
}

void append_edges(const Mesh& mesh, const auto& place, std::string& bytes, std::uint32_t& count) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f], n = mesh.valence(f);
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = mesh.corner_vertex[begin + i],
                          b = mesh.corner_vertex[begin + (i + 1) % n];
      if (a > b) continue;  // the face across has it, and a border's side that turns so is drawn
      append_floats(bytes, place(mesh.positions[a]));
      append_floats(bytes, place(mesh.positions[b]));
      ++count;
    }
  }
}

}  // namespace

std::string geometry_of(const SceneObject& object, std::uint32_t number, std::size_t most) {
  const PatchCache& cache = *object.cache;
  const Mesh mesh = mesh_of(cache);
  const auto place = [&](const Vec3& p) { return Vec3(object.pose * (p * cache.unit)); };
  const std::uint32_t rings = rings_of(cache, most);
  std::map<std::uint32_t, Fan> fans;
  std::vector<DomainPoint> where;
  std::string triangles;
  std::uint32_t triangle_count = 0;
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    const std::uint32_t n = cache.face_valence[face];
    const Fan& fan = fans.try_emplace(n, n, rings).first->second;
    const auto first = static_cast<std::uint32_t>(where.size());
    for (const auto& [xi, eta] : fan.points) where.push_back({face, xi, eta});
    for (const std::uint32_t i : fan.triangles) append_bytes(triangles, first + i);
    triangle_count += static_cast<std::uint32_t>(fan.triangles.size() / 3);
  }
  std::vector<SurfacePoint> points(where.size());
  evaluate(cache, where, points);

  std::string positions, normals, heights, faces;
  Vec3 middle = Vec3::Zero(), up = Vec3::Zero();
  std::uint32_t last = kNone, kind = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint32_t face = where[i].face;
    if (face != last) {
      last = face;
      kind = static_cast<std::uint32_t>(cache.kind[cache.first_patch(face)]);
      up = newell_normal(mesh, face).normalized();
      middle.setZero();
      const std::uint32_t n = mesh.valence(face);
      for (std::uint32_t c = 0; c < n; ++c)
        middle += mesh.positions[mesh.corner_vertex[mesh.face_begin[face] + c]] / n;
    }
    append_floats(positions, place(points[i].position));
    const Vec3 normal = object.pose.linear() * points[i].normal;
    for (int axis = 0; axis < 3; ++axis)
      append_bytes(normals, static_cast<std::int8_t>(std::lround(127 * normal[axis])));
    append_bytes(normals, static_cast<std::uint8_t>(kind));
    append_bytes(heights, static_cast<float>((points[i].position - middle).dot(up) * cache.unit));
    append_bytes(faces, face);
  }

  std::string edges, polygons;
  std::uint32_t edge_count = 0;
  append_edges(mesh, place, edges, edge_count);
  const std::vector<Vec3> corners = triangles_of(mesh);
  for (const Vec3& corner : corners) append_floats(polygons, place(corner));

  std::string bytes;
  for (const std::uint32_t head :
       {kGeometryMark, number, static_cast<std::uint32_t>(points.size()), triangle_count,
        edge_count, static_cast<std::uint32_t>(corners.size() / 3), 0U, 0U})
    append_bytes(bytes, head);
  for (const std::string* part :
       {&positions, &normals, &heights, &faces, &triangles, &edges, &polygons})
    bytes += *part;
  return bytes;
}

}  // namespace gliss::tools
