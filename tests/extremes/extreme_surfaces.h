// The surfaces that the tests at the extremes ask: smooth, thin, sharp, folded, with poles, open;
// each with its cache in both precisions and its oracle. Those named "fair ..." have the patches of
// the fair construction, the others the paper's.
#pragma once

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/dense_oracle.h"
#include "tests/support/open_meshes.h"

namespace gliss::test {

// A sphere of 24 segments: its poles have valence 24.
Mesh lat_long_sphere(int segments = 24, int rings = 12, double radius = 10);

// Two fans of 24 triangles: poles that are blunt, a rim that is sharp.
Mesh two_fans(int segments = 24, double radius = 10, double height = 5);

// A sphere whose vertex normals are tilted so far that patches fold.
Mesh crumpled(double tilt = 1.25);

// The first faces of a mesh, as a mesh of their own.
Mesh first_faces(Mesh mesh, std::uint32_t count);

// Makes what `gliss bake --region` does: patches of the first faces of a mesh, the others known but
// not built.
PatchCache region_of(const Mesh& whole, std::uint32_t count, Precision precision,
                     BuildReport* report = nullptr);

struct Extreme {
  std::string name;
  Mesh mesh;
  Topology topology;
  BuildReport report;
  PatchCache cache, narrow;  // double, float
  DenseOracle oracle;
  double size, rho;  // diagonal of its box; least radius of curvature

  Extreme(std::string of, Mesh m, Construction construction)
      : name(std::move(of)),
        mesh(std::move(m)),
        topology(build_topology(mesh)),
        cache(cache_of(mesh, Precision::kDouble, true, &report, construction)),
        narrow(cache_of(mesh, Precision::kFloat, true, nullptr, construction)),
        oracle(cache, mesh.face_count() < 100 ? 16 : 8),
        size(size_of(mesh)),
        rho(cache.smallest_rho()) {}

  // A region of a mesh: `mesh` is its faces.
  Extreme(std::string of, const Mesh& whole, std::uint32_t faces)
      : name(std::move(of)),
        mesh(first_faces(with_normals(whole), faces)),
        topology(build_topology(mesh)),
        cache(region_of(with_normals(whole), faces, Precision::kDouble, &report)),
        narrow(region_of(with_normals(whole), faces, Precision::kFloat)),
        oracle(cache, mesh.face_count() < 100 ? 16 : 8),
        size(size_of(mesh)),
        rho(cache.smallest_rho()) {}

  // Least radius of curvature of a face.
  double rho_of(std::uint32_t face) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t patch = cache.first_patch(face);
         patch < cache.patch_count() && cache.patch_face[patch] == face; ++patch)
      least = std::min(least, cache.rho_min[patch]);
    return least;
  }

  Vec3 middle() const {
    const Box box = cache.bounds();
    return 0.5 * (box.low + box.high);
  }
};

// Those with borders.
inline const std::vector<const char*> kOpenExtremes{"open strip", "open fan", "half torus",
                                                    "triangle", "region"};

// Fair ones: quads that are thin and sharp, or round; triangles of all shapes, and at poles of
// valence 24; the last two with borders.
inline const std::vector<const char*> kFairExtremes{
    "fair fin", "fair banana", "fair irregular", "fair sphere", "fair open strip", "fair open fan"};

// Made at the first use.
const Extreme& extreme(const std::string& name);

}  // namespace gliss::test
