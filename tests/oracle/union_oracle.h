// Overlapping parts and what their union is, by means that share nothing with the kernels' own
// union: a cache for each part by itself, winding numbers of triangles, dense samples, formulas.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "gliss/generate/generate.h"
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

// Larger than that of the corners by a tenth of the longest side all round, since patches bulge
// beyond them.
inline Box box_round(const PatchCache& cache) {
  const Box box = cache.bounds();
  const Vec3 margin = Vec3::Constant(0.1 * (box.high - box.low).maxCoeff());
  return {box.low - margin, box.high + margin};
}

class UnionOracle {
 public:
  // Takes so many samples along each side of a face; 0: none.
  explicit UnionOracle(const std::vector<Mesh>& parts, int resolution) {
    for (const Mesh& mesh : parts) parts_.push_back(cache_of(mesh));
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

  // The depth of a point in the parts but one, at most; negative outside, where it may be nearer to
  // them than this says.
  double depth(const Vec3& x, std::size_t but = ~std::size_t{0}) const {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      if (part == but) continue;
      const double beyond = beyond_box(part, x);
      most = std::max(most, beyond > 0 ? -beyond : -nearest(parts_[part], x).distance);
    }
    return most;
  }

  // The distance of a point from the nearest surface of any part.
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
  // From the box that a part is in.
  double beyond_box(std::size_t part, const Vec3& x) const {
    const Box box = box_round(parts_[part]);
    return (box.low - x).cwiseMax(x - box.high).cwiseMax(0.0).norm();
  }

  std::vector<PatchCache> parts_;
  std::vector<Vec3> exposed_;
};

// A union of boxes along the axes, by formula: the planes of their sides cut space into cells, each
// of which is full or empty.
class BoxUnion {
 public:
  explicit BoxUnion(const std::vector<Box>& boxes) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double>& planes = planes_[static_cast<std::size_t>(axis)];
      planes = {-infinity, infinity};
      for (const Box& box : boxes) planes.insert(planes.end(), {box.low[axis], box.high[axis]});
      std::sort(planes.begin(), planes.end());
      planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    }
    const auto& [x, y, z] = planes_;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      for (std::size_t j = 0; j + 1 < y.size(); ++j) {
        for (std::size_t k = 0; k + 1 < z.size(); ++k) {
          const Box cell{{x[i], y[j], z[k]}, {x[i + 1], y[j + 1], z[k + 1]}};
          const bool full = std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
            return (cell.low - box.low).minCoeff() >= 0 && (box.high - cell.high).minCoeff() >= 0;
          });
          (full ? full_ : empty_).push_back(cell);
        }
      }
    }
  }

  // To the surface of the union; negative inside.
  double distance(const Vec3& x) const {
    const double out = to(full_, x);
    return out > 0 ? out : -to(empty_, x);
  }

 private:
  static double to(const std::vector<Box>& cells, const Vec3& x) {
    double least = std::numeric_limits<double>::infinity();
    for (const Box& cell : cells)
      least = std::min(least, (cell.low - x).cwiseMax(x - cell.high).cwiseMax(0.0).norm());
    return least;
  }

  std::array<std::vector<double>, 3> planes_;
  std::vector<Box> full_, empty_;
};

// Counts how often the parts go round a point, by the solid angles of triangles (van Oosterom and
// Strackee 1983), which are cut until they are as near to the surface as the point's distance asks
// for. One thread's at a time.
class Winding {
 public:
  // Right for points that are farther than `least` from all surfaces.
  Winding(const std::vector<Mesh>& parts, double least) : least_(least) {
    for (const Mesh& part : parts) {
      PatchCache cache = cache_of(part);
      const Box box = box_round(cache);
      parts_.push_back({std::move(cache), box, {}});
      Part& p = parts_.back();
      for (std::uint32_t face = 0; face < p.cache.mesh_face_count; ++face) {
        const int n = static_cast<int>(p.cache.face_valence[face]);
        for (int k = 0; k < n; ++k) {
          std::array<Corner, 3> corner;
          corner[0].X.setZero();
          corner[1].X = oracle::domain_corner<double>(n, k);
          corner[2].X = oracle::domain_corner<double>(n, k + 1);
          place(p.cache, face, corner);
          p.triangles.push_back(triangle(p.cache, face, corner));
        }
      }
    }
  }

  double at(const Vec3& x) const {
    double angle = 0;
    for (const Part& part : parts_) {
      if ((part.box.low - x).cwiseMax(x - part.box.high).maxCoeff() > 0) continue;
      for (const Triangle& t : part.triangles) angle += seen(part.cache, t, x, 0);
    }
    return angle / (4 * std::numbers::pi);
  }

 private:
  static constexpr int kDeepest = 24, kKept = 3;  // times that a triangle is cut; that stay in
                                                  // memory

  struct Corner {
    Vec2 X;
    Vec3 x;
  };
  struct Triangle {
    std::uint32_t face;
    std::array<Corner, 3> corner, middle;  // middle[k]: of the side that begins at corner k
    Vec3 centre;
    double radius, off;  // off: the middles from the straight sides, at most
    mutable std::vector<Triangle> parts = {};
  };
  struct Part {
    PatchCache cache;
    Box box;
    std::vector<Triangle> triangles;
  };

  static void place(const PatchCache& cache, std::uint32_t face, std::array<Corner, 3>& corners) {
    std::array<DomainPoint, 3> points;
    std::array<SurfacePoint, 3> there;
    for (std::size_t k = 0; k < 3; ++k) points[k] = {face, corners[k].X.x(), corners[k].X.y()};
    evaluate(cache, points, there);
    for (std::size_t k = 0; k < 3; ++k) corners[k].x = there[k].position;
  }
  static Triangle triangle(const PatchCache& cache, std::uint32_t face,
                           const std::array<Corner, 3>& corner) {
    Triangle t{face, corner, {}, (corner[0].x + corner[1].x + corner[2].x) / 3, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) t.middle[k].X = (corner[k].X + corner[(k + 1) % 3].X) / 2;
    place(cache, face, t.middle);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = corner[k].x, &b = corner[(k + 1) % 3].x, &middle = t.middle[k].x;
      t.off = std::max(t.off, (middle - (a + b) / 2).norm());
      t.radius = std::max({t.radius, (a - t.centre).norm(), (middle - t.centre).norm()});
    }
    return t;
  }
  static std::vector<Triangle> cut(const PatchCache& cache, const Triangle& t) {
    const auto& [a, b, c] = t.corner;
    const auto& [ab, bc, ca] = t.middle;
    return {triangle(cache, t.face, {a, ab, ca}), triangle(cache, t.face, {ab, b, bc}),
            triangle(cache, t.face, {ca, bc, c}), triangle(cache, t.face, {ab, bc, ca})};
  }

  double seen(const PatchCache& cache, const Triangle& t, const Vec3& x, int depth) const {
    const double distance = std::max(least_, (x - t.centre).norm() - 1.2 * t.radius);
    // Near triangles are cut twice at least, for a bend may hide between middles.
    const bool is_fine = t.off < 0.02 * distance && (distance > t.radius || depth >= 2);
    if (is_fine || depth == kDeepest)
      return angle_of(t.corner[0].x - x, t.corner[1].x - x, t.corner[2].x - x);
    if (depth < kKept && t.parts.empty()) t.parts = cut(cache, t);
    double sum = 0;
    for (const Triangle& part : depth < kKept ? t.parts : cut(cache, t))
      sum += seen(cache, part, x, depth + 1);
    return sum;
  }
  static double angle_of(const Vec3& p, const Vec3& q, const Vec3& r) {
    const double a = p.norm(), b = q.norm(), c = r.norm();
    return 2 *
           std::atan2(p.dot(q.cross(r)), a * b * c + p.dot(q) * c + q.dot(r) * a + r.dot(p) * b);
  }

  std::vector<Part> parts_;
  double least_;
};

}  // namespace gliss::test
