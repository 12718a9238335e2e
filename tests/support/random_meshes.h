// Irregular meshes made from random points, each with vertex normals of its own choice.
#pragma once

#include <array>
#include <set>
#include <utility>

#include "gliss/mesh/topology.h"
#include "tests/oracle/oracle.h"

namespace gliss::test {

using oracle::Rng;

inline void add_face(Mesh& mesh, std::initializer_list<std::uint32_t> corners) {
  mesh.corner_vertex.insert(mesh.corner_vertex.end(), corners);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
}

/// Gives every vertex one normal: `exact` of its position, tilted by up to `tilt` (rad).
template <class Exact>
void add_normals(Mesh& mesh, Rng& rng, double tilt, Exact exact) {
  for (const Vec3& p : mesh.positions)
    mesh.normals.push_back(oracle::random_tilt(rng, exact(p).normalized(), tilt));
  mesh.corner_normal = mesh.corner_vertex;
}

/// The triangles of a convex hull, anticlockwise seen from outside. No four points may lie in a
/// plane.
inline std::vector<std::array<std::uint32_t, 3>> hull_of(const std::vector<Vec3>& points) {
  using Triangle = std::array<std::uint32_t, 3>;
  const auto sees = [&](std::uint32_t p, const Triangle& t) {
    const Vec3 a = points[t[0]] - points[p], b = points[t[1]] - points[p];
    return a.cross(b).dot(points[t[2]] - points[p]) < 0;
  };
  std::vector<Triangle> hull{{0, 1, 2}, {0, 2, 1}};
  if (sees(3, hull[0])) std::swap(hull[0], hull[1]);
  // The fourth point sees one of the two sides of the first triangle, and takes it away.
  for (std::uint32_t p = 3; p < points.size(); ++p) {
    std::vector<Triangle> kept;
    std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
    for (const Triangle& t : hull) {
      if (!sees(p, t)) {
        kept.push_back(t);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) seen.insert({t[k], t[(k + 1) % 3]});
    }
    for (const auto& [from, to] : seen) {
      if (!seen.count({to, from})) kept.push_back({from, to, p});
    }
    hull = std::move(kept);
  }
  return hull;
}

/// `count` random points, none nearer to another by `distance(a, b)` than `apart`.
template <class Make, class Distance>
auto points_apart(int count, double apart, Make make, Distance distance) {
  std::vector<decltype(make())> points;
  while (points.size() < static_cast<std::size_t>(count)) {
    const auto made = make();
    const bool is_apart = std::all_of(points.begin(), points.end(),
                                      [&](const auto& p) { return distance(p, made) >= apart; });
    if (is_apart) points.push_back(made);
  }
  return points;
}

/// Points of a surface are apart by this share of the side of a square that holds one of them.
inline constexpr double kApart = 0.5;

/// Random points of a sphere and their hull.
inline Mesh random_sphere(Rng& rng, int count, double radius, double tilt = 0) {
  Mesh mesh;
  mesh.source = "random sphere";
  mesh.positions = points_apart(
      count, kApart * radius * std::sqrt(4 * std::numbers::pi / count),
      [&] { return Vec3(radius * oracle::random_unit(rng)); },
      [](const Vec3& a, const Vec3& b) { return (a - b).norm(); });
  for (const auto& t : hull_of(mesh.positions)) add_face(mesh, {t[0], t[1], t[2]});
  add_normals(mesh, rng, tilt, [](const Vec3& p) { return p; });
  return mesh;
}

/// The hull of random points of a sphere, stretched to an ellipsoid with these half axes.
inline Mesh random_ellipsoid(Rng& rng, int count, const Vec3& half) {
  Mesh mesh = random_sphere(rng, count, 1);
  mesh.source = "random ellipsoid";
  for (Vec3& p : mesh.positions) p = p.cwiseProduct(half);
  mesh.normals.clear();
  add_normals(mesh, rng, 0, [&](const Vec3& p) { return Vec3(p.cwiseQuotient(half.cwiseAbs2())); });
  return mesh;
}

using Flat = std::array<double, 2>;
/// Random points of a rectangle whose opposite sides are one, joined by Delaunay's rule.
struct Unrolled {
  std::vector<Flat> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};
inline Unrolled random_unrolled(Rng& rng, int count, double width, double height) {
  Unrolled made;
  made.points = points_apart(
      count, kApart * std::sqrt(width * height / count),
      [&] {
        const double u = oracle::uniform(rng, 0, width);
        return Flat{u, oracle::uniform(rng, 0, height)};
      },
      [&](const Flat& a, const Flat& b) {
        return std::hypot(std::remainder(a[0] - b[0], width), std::remainder(a[1] - b[1], height));
      });
  // The hull of a paraboloid, over the rectangle and as much again around it.
  std::vector<Vec3> lifted;
  std::vector<std::uint32_t> vertex;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (std::uint32_t i = 0; i < made.points.size(); ++i) {
        const double u = made.points[i][0] + x * width, v = made.points[i][1] + y * height;
        if (std::abs(u / width - 0.5) > 1 || std::abs(v / height - 0.5) > 1) continue;
        lifted.push_back({u, v, u * u + v * v});
        vertex.push_back(i);
      }
    }
  }
  for (const auto& t : hull_of(lifted)) {
    const Vec3 a = lifted[t[0]], b = lifted[t[1]], c = lifted[t[2]], middle = (a + b + c) / 3;
    const bool below = (b - a).cross(c - a).z() < 0;
    const bool here =
        middle.x() >= 0 && middle.x() < width && middle.y() >= 0 && middle.y() < height;
    // Seen from below, anticlockwise is clockwise.
    if (below && here) made.triangles.push_back({vertex[t[0]], vertex[t[2]], vertex[t[1]]});
  }
  return made;
}

/// Random points of a torus, joined in its unrolled rectangle.
inline Mesh random_torus(Rng& rng, int count, double R, double r, double tilt = 0) {
  const double pi = std::numbers::pi;
  const Unrolled flat = random_unrolled(rng, count, 2 * pi * R, 2 * pi * r);
  Mesh mesh;
  mesh.source = "random torus";
  for (const auto& p : flat.points) {
    const double u = p[0] / R, v = p[1] / r, from_axis = R + r * std::cos(v);
    mesh.positions.push_back({from_axis * std::cos(u), from_axis * std::sin(u), r * std::sin(v)});
  }
  for (const auto& t : flat.triangles) add_face(mesh, {t[0], t[1], t[2]});
  add_normals(mesh, rng, tilt,
              [&](const Vec3& p) { return Vec3(p - R * Vec3(p.x(), p.y(), 0).normalized()); });
  return mesh;
}

/// Random points of a cylinder's mantle, joined in its unrolled rectangle; its borders are ragged.
inline Mesh random_cylinder(Rng& rng, int count, double radius, double height) {
  const Unrolled flat = random_unrolled(rng, count, 2 * std::numbers::pi * radius, height);
  Mesh mesh;
  mesh.source = "random cylinder";
  for (const auto& p : flat.points) {
    const double u = p[0] / radius;
    mesh.positions.push_back({radius * std::cos(u), radius * std::sin(u), p[1]});
  }
  for (const auto& t : flat.triangles) {
    const auto [low, high] =
        std::minmax({mesh.positions[t[0]].z(), mesh.positions[t[1]].z(), mesh.positions[t[2]].z()});
    if (high - low < height / 2) add_face(mesh, {t[0], t[1], t[2]});
  }
  add_normals(mesh, rng, 0, [](const Vec3& p) { return Vec3(p.x(), p.y(), 0); });
  return mesh;
}

struct SheetOptions {
  int cells = 7;
  double shake = 0.3;  // of a square's side
  double wave = 0.4;
  double tilt = 0;         // of the normals, rad
  bool has_quads = false;  // some squares are not cut, and one takes a half of the next
  bool has_seam = false;   // along the middle, each side has normals of its own
  bool has_dart = false;   // a seam that ends in the middle of the sheet
};
/// A sheet of `cells` x `cells` squares with shaken corners, bent over a wave, each cut along one
/// of its diagonals.
inline Mesh random_sheet(Rng& rng, const SheetOptions& options) {
  const auto n = static_cast<std::uint32_t>(options.cells);
  const auto height = [&](double x, double y) {
    return options.wave *
           (std::sin(1.1 * x + 0.3) * std::cos(0.8 * y) + 0.4 * std::sin(x + 1.3 * y));
  };
  Mesh mesh;
  mesh.source = "random sheet";
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t j = 0; j <= n; ++j) {
      const double x = i + oracle::uniform(rng, -options.shake, options.shake);
      double y = j + oracle::uniform(rng, -options.shake, options.shake);
      if (options.has_quads && i == 3 && j == 2) y -= 0.4;  // the pentagon has a corner there
      mesh.positions.push_back({x, y, height(x, y)});
    }
  }
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) { return i * (n + 1) + j; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1),
                          d = vertex(i, j + 1);
      const double dice = oracle::uniform(rng, 0, 1);
      if (options.has_quads && i == 2 && j == 2) {
        add_face(mesh, {a, b, vertex(i + 2, j), c, d});
      } else if (options.has_quads && i == 3 && j == 2) {
        add_face(mesh, {b, c, d});
      } else if (options.has_quads && dice > 0.7) {
        add_face(mesh, {a, b, c, d});
      } else if (dice < 0.4) {
        add_face(mesh, {a, b, c});
        add_face(mesh, {a, c, d});
      } else {
        add_face(mesh, {a, b, d});
        add_face(mesh, {b, c, d});
      }
    }
  }
  add_normals(mesh, rng, options.tilt, [&](const Vec3& p) {
    const double h = 1e-6, x = p.x(), y = p.y();
    return Vec3(height(x - h, y) - height(x + h, y), height(x, y - h) - height(x, y + h), 2 * h);
  });
  // Faces beyond the middle row of vertices have normals of their own at so many of them.
  const std::uint32_t split = options.has_seam ? n + 1 : options.has_dart ? n / 2 : 0;
  std::vector<std::uint32_t> other(split);
  for (std::uint32_t j = 0; j < split; ++j) {
    other[j] = static_cast<std::uint32_t>(mesh.normals.size());
    const Vec3 normal = mesh.normals[vertex(n / 2, j)];
    mesh.normals.push_back((normal + Vec3(0.5, 0, 0)).normalized());
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    std::uint32_t most = 0;
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
      most = std::max(most, mesh.corner_vertex[c] / (n + 1));
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
      const std::uint32_t v = mesh.corner_vertex[c];
      if (most > n / 2 && v / (n + 1) == n / 2 && v % (n + 1) < split)
        mesh.corner_normal[c] = other[v % (n + 1)];
    }
  }
  return mesh;
}

}  // namespace gliss::test
