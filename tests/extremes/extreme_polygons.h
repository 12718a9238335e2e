// Polygons at the edge of what a mesh may hold, by name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/surfaces.h"

namespace gliss::test {

struct NamedPolygon {
  std::string name;
  Polygon polygon;
};

inline Polygon regular(int n) {
  Polygon p;
  for (int k = 0; k < n; ++k) {
    const Vec2 X = oracle::domain_corner(n, k);
    p.positions.push_back({X.x(), X.y(), 0});
    p.normals.push_back(Vec3::UnitZ());
  }
  return p;
}

// A random polygon whose normals leave that of its face by exactly `tilt` (rad).
inline Polygon tilted(oracle::Rng& rng, int n, double tilt) {
  Polygon p = oracle::random_polygon(rng, n, 0);
  const Vec3 up = oracle::face_normal(p), x = up.unitOrthogonal(), y = up.cross(x);
  for (Vec3& normal : p.normals) {
    const double turn = oracle::uniform(rng, 0, 2 * std::numbers::pi);
    normal = (std::cos(tilt) * up + std::sin(tilt) * (std::cos(turn) * x + std::sin(turn) * y))
                 .normalized();
  }
  return p;
}

// Polygons of n sides where eq. 7 to 9 degenerate at the ends of edge 0.
inline std::vector<NamedPolygon> degenerate_normals(oracle::Rng& rng, int n) {
  std::vector<NamedPolygon> all;
  const auto add = [&](const std::string& name, const std::function<void(Polygon&)>& change) {
    Polygon p = oracle::random_polygon(rng, n, 0.3);
    change(p);
    all.push_back({fmt::format("{} of {} sides", name, n), oracle::with_unit_normals(p)});
  };
  const auto along = [](const Polygon& p, int k) {
    return Vec3((p.position(k + 1) - p.position(k)).normalized());
  };
  add("opposed normals", [](Polygon& p) { p.normals[1] = -p.normals[0]; });
  add("nearly opposed normals",
      [&](Polygon& p) { p.normals[1] = -p.normals[0] + 1e-7 * oracle::random_unit(rng); });
  add("normals opposed in the plane", [&](Polygon& p) {
    p.normals[0] = along(p, 0).cross(oracle::face_normal(p));
    p.normals[1] = -p.normals[0];
  });
  add("normal along its edge", [&](Polygon& p) { p.normals[0] = along(p, 0); });
  add("normal against its edge", [&](Polygon& p) { p.normals[1] = -along(p, 0); });
  add("both normals along their edge",
      [&](Polygon& p) { p.normals[0] = p.normals[1] = along(p, 0); });
  for (const double off : {1e-2, 1e-3, 1e-5, 1e-8, 1e-12}) {
    add(fmt::format("normal along its edge but for {}", off),
        [&](Polygon& p) { p.normals[0] = along(p, 0) + off * oracle::random_unit(rng); });
  }
  add("all normals equal", [&](Polygon& p) {
    for (Vec3& m : p.normals) m = p.normals[0];
  });
  add("all normals equal, in the plane", [&](Polygon& p) {
    const Vec3 in_plane = oracle::face_normal(p).unitOrthogonal();
    for (Vec3& m : p.normals) m = in_plane;
  });
  add("normals outward in the plane", [](Polygon& p) {
    const Vec3 up = oracle::face_normal(p);
    for (int k = 0; k < p.size(); ++k)
      p.normals[static_cast<std::size_t>(k)] = (p.position(k + 1) - p.position(k - 1)).cross(up);
  });
  add("normals against the face", [](Polygon& p) {
    for (Vec3& m : p.normals) m = -m;
  });
  return all;
}

// The polygon with normals that leave that of its face by up to `tilt` (rad).
inline NamedPolygon with_tilt(oracle::Rng& rng, const std::string& name, Polygon p, double tilt) {
  const Vec3 up = oracle::face_normal(p);
  for (Vec3& m : p.normals) m = oracle::random_tilt(rng, up, tilt);
  return {fmt::format("{}, tilt {}", name, tilt), oracle::with_unit_normals(std::move(p))};
}

// Polygons of size 2 whose edge 0 has that length, from a vertex at the origin, so that it is not
// rounded.
inline std::vector<NamedPolygon> short_edges(oracle::Rng& rng, double length) {
  std::vector<NamedPolygon> all;
  for (const double tilt : {0.0, 0.3}) {
    for (const int n : {3, 4, 5, 7}) {
      Polygon p = regular(n);
      for (Vec3& v : p.positions) v.x() -= 1;
      p.positions[1] *= length;
      all.push_back(with_tilt(rng, fmt::format("edge of {}, {} sides", length, n), p, tilt));
    }
  }
  return all;
}

// Shapes that no modeller means to make, and what scanners and decimation leave.
inline std::vector<NamedPolygon> odd_shapes(oracle::Rng& rng) {
  std::vector<NamedPolygon> all;
  const auto stretched = [](int n, double y) {
    Polygon p = regular(n);
    for (Vec3& v : p.positions) v.y() *= y;
    return p;
  };
  for (const double tilt : {0.0, 0.3}) {
    const auto add = [&](const std::string& name, const Polygon& p) {
      all.push_back(with_tilt(rng, name, p, tilt));
    };
    for (const int n : {3, 4, 5, 7}) {
      for (const double thin : {1e-2, 1e-4, 1e-6})
        add(fmt::format("sliver 1 : {} of {} sides", thin, n), stretched(n, thin));
    }
    for (const int points : {3, 5, 9}) {
      for (const double inner : {0.5, 0.2, 0.02}) {
        Polygon star = regular(2 * points);
        for (std::size_t k = 1; k < star.positions.size(); k += 2) star.positions[k] *= inner;
        add(fmt::format("star of {} points, inner radius {}", points, inner), star);
      }
    }
    Polygon arrow = regular(4);
    arrow.positions[2] = {0.6, 0, 0};
    add("concave quad", arrow);
    for (const double height : {0.3, 1.0, 3.0}) {
      Polygon saddle = regular(6);
      for (std::size_t k = 0; k < 6; ++k) saddle.positions[k].z() = k % 2 == 0 ? height : -height;
      add(fmt::format("saddle of height {}", height), saddle);
    }
    for (const auto& [n, step] : {std::pair{5, 2}, {7, 2}, {7, 3}}) {
      Polygon crossing;
      for (int k = 0; k < n; ++k) crossing.positions.push_back(regular(n).position(step * k));
      crossing.normals.assign(static_cast<std::size_t>(n), Vec3::UnitZ());
      add(fmt::format("self-crossing {}/{}", n, step), crossing);
    }
    Polygon bow = regular(4);
    std::swap(bow.positions[1], bow.positions[2]);
    bow.positions[3] *= 1.5;
    add("bow tie", bow);
  }
  return all;
}

}  // namespace gliss::test
