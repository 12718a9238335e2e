// Overlapping parts and what their union is, by means that share nothing with the kernels' own
// union: a cache for each part by itself, winding numbers of a fine tessellation, dense samples.
#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "gliss/generate/generate.h"
#include "gliss/study/tessellate.h"
#include "tests/support/surfaces.h"

namespace gliss::test {

inline Mesh moved(Mesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.positions) p += by;
  return mesh;
}

// Parts side by side in one mesh; all have normals or none has.
inline Mesh joined(const std::vector<Mesh>& parts) {
  Mesh mesh;
  mesh.unit = parts.front().unit;
  for (const Mesh& part : parts) {
    const auto vertices = static_cast<std::uint32_t>(mesh.positions.size()),
               normals = static_cast<std::uint32_t>(mesh.normals.size()),
               corners = static_cast<std::uint32_t>(mesh.corner_vertex.size());
    for (const std::uint32_t v : part.corner_vertex) mesh.corner_vertex.push_back(vertices + v);
    for (const std::uint32_t n : part.corner_normal) mesh.corner_normal.push_back(normals + n);
    for (std::size_t f = 1; f < part.face_begin.size(); ++f)
      mesh.face_begin.push_back(corners + part.face_begin[f]);
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  }
  return mesh;
}

// The closed parts of a mesh, each a mesh of its own.
inline std::vector<Mesh> parts_of(const Mesh& mesh) {
  const Topology topology = build_topology(mesh);
  std::vector<char> seen(mesh.face_count(), 0);
  std::vector<Mesh> parts;
  for (std::uint32_t first = 0; first < mesh.face_count(); ++first) {
    if (seen[first]) continue;
    Mesh part;
    part.unit = mesh.unit;
    part.positions = mesh.positions;
    part.normals = mesh.normals;
    std::vector<std::uint32_t> faces{first};
    seen[first] = 1;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::uint32_t s = mesh.face_begin[faces[i]]; s < mesh.face_begin[faces[i] + 1]; ++s) {
        part.corner_vertex.push_back(mesh.corner_vertex[s]);
        part.corner_normal.push_back(mesh.corner_normal[s]);
        const std::uint32_t next = topology.side_face[topology.side_twin[s]];
        if (!std::exchange(seen[next], 1)) faces.push_back(next);
      }
      part.face_begin.push_back(static_cast<std::uint32_t>(part.corner_vertex.size()));
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

class UnionOracle {
 public:
  // Takes so many samples along each side of a face; 0: none.
  explicit UnionOracle(const std::vector<Mesh>& parts, int resolution) {
    for (const Mesh& mesh : parts) parts_.push_back(cache_of(with_normals(mesh)));
    if (resolution == 0) return;
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const PatchCache& cache = parts_[part];
      for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
        const int n = static_cast<int>(cache.face_valence[face]);
        for (const Vec2& X : oracle::sample_domain<double>(n, resolution)) {
          const Vec3 x = at(cache, face, X).position;
          if (depth(x, part) <= 0) exposed_.push_back(x);
        }
      }
    }
  }

  // How deep a point lies in the parts but one, at most; negative outside, where it may be nearer
  // to them than this says.
  double depth(const Vec3& x, std::size_t but = ~std::size_t{0}) const {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      if (part == but) continue;
      const double beyond = beyond_box(part, x);
      most = std::max(most, beyond > 0 ? -beyond : -nearest(parts_[part], x).distance);
    }
    return most;
  }

  // How far a point is from the nearest surface of any part.
  double off_surface(const Vec3& x) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      if (beyond_box(part, x) < least)
        least = std::min(least, std::abs(nearest(parts_[part], x).distance));
    }
    return least;
  }

  // To the nearest sample of the union's surface: never less than to the surface.
  double to_samples(const Vec3& x) const {
    double least2 = std::numeric_limits<double>::infinity();
    for (const Vec3& p : exposed_) least2 = std::min(least2, (p - x).squaredNorm());
    return std::sqrt(least2);
  }

 private:
  // From the box of a part, larger than it by a tenth, since patches bulge beyond their corners.
  double beyond_box(std::size_t part, const Vec3& x) const {
    const Box box = parts_[part].bounds();
    const Vec3 margin = 0.1 * (box.high - box.low);
    return (box.low - margin - x).cwiseMax(x - box.high - margin).cwiseMax(0.0).norm();
  }

  std::vector<PatchCache> parts_;
  std::vector<Vec3> exposed_;
};

// How often fine triangulations of the parts go round a point, by solid angles (van Oosterom and
// Strackee 1983).
class Winding {
 public:
  Winding(const std::vector<Mesh>& parts, std::uint32_t cells) {
    for (const Mesh& part : parts) {
      const Mesh mesh = with_normals(part);
      const Mesh fine = tessellate(mesh, cache_of(mesh), cells);
      Part p{{}, fine.positions.front(), fine.positions.front()};
      for (const std::uint32_t v : fine.corner_vertex) {
        p.corner.push_back(fine.positions[v]);
        p.low = p.low.cwiseMin(p.corner.back());
        p.high = p.high.cwiseMax(p.corner.back());
      }
      parts_.push_back(std::move(p));
    }
  }

  double at(const Vec3& x) const {
    double angle = 0;
    for (const Part& part : parts_) {
      if ((part.low - x).cwiseMax(x - part.high).maxCoeff() > 0) continue;
      for (std::size_t t = 0; t < part.corner.size(); t += 3) {
        const Vec3 p = part.corner[t] - x, q = part.corner[t + 1] - x, r = part.corner[t + 2] - x;
        const double a = p.norm(), b = q.norm(), c = r.norm();
        angle += 2 * std::atan2(p.dot(q.cross(r)),
                                a * b * c + p.dot(q) * c + q.dot(r) * a + r.dot(p) * b);
      }
    }
    return angle / (4 * std::numbers::pi);
  }

 private:
  struct Part {
    std::vector<Vec3> corner;  // of triangles
    Vec3 low, high;
  };
  std::vector<Part> parts_;
};

}  // namespace gliss::test
