// The mesh of a cache is the mesh that it was built from.
#include "gliss/build/cache_mesh.h"

#include "gliss/build/build_cache.h"
#include "gliss/generate/generate.h"
#include "gliss/mesh/topology.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

TEST(CacheMesh, has_the_polygons_and_normals_of_the_cache) {
  for (const Mesh& given : {torus_knot(40, 6).mesh, goldberg(2).mesh, thin_plate().mesh, fin().mesh,
                            prism(5).mesh, test::sheet(1.5), test::half_torus()}) {
    for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
      const Mesh mesh = test::with_normals(given);
      const double rounding =
          (precision == Precision::kDouble ? 1e-14 : 1e-6) * test::size_of(mesh);
      const Mesh made = mesh_of(test::cache_of(mesh, precision));
      ASSERT_EQ(made.face_begin, mesh.face_begin);
      EXPECT_EQ(made.unit, mesh.unit);
      for (std::size_t c = 0; c < mesh.corner_vertex.size(); ++c) {
        const Vec3 &p = mesh.positions[mesh.corner_vertex[c]],
                   &n = mesh.normals[mesh.corner_normal[c]];
        EXPECT_LE((made.positions[made.corner_vertex[c]] - p).norm(), rounding) << mesh.source;
        EXPECT_LE((made.normals[made.corner_normal[c]] - n).norm(), 1e-6) << mesh.source;
      }
      // No vertex came apart, nor did two become one.
      const Topology was = build_topology(mesh), is = build_topology(made);
      EXPECT_EQ(is.side_twin, was.side_twin) << mesh.source;
      EXPECT_EQ(made.positions.size(), mesh.positions.size()) << mesh.source;
    }
  }
}

TEST(CacheMesh, has_the_creases_across_which_normals_differ) {
  for (const Mesh& mesh : {test::with_creases(test::l_solid()), test::with_creases(cylinder().mesh),
                           test::with_creases(fin().mesh)}) {
    const PatchCache cache = test::cache_of(mesh);
    const Mesh made = mesh_of(cache);
    EXPECT_EQ(made.sharp, mesh.sharp) << mesh.source;
    const PatchCache again = build_cache(made);
    std::visit(
        [&](const auto& s) {
          const auto& own = std::get<Surface<double>>(again.surface).control;
          ASSERT_EQ(own.size(), s.control.size());
          for (std::size_t i = 0; i < own.size(); ++i)
            ASSERT_NEAR(own[i], static_cast<double>(s.control[i]), 1e-9) << mesh.source;
        },
        cache.surface);
  }
}

TEST(CacheMesh, is_not_to_be_had_of_single_faces) {
  BuildOptions few;
  few.faces = {0, 1};
  EXPECT_THROW(mesh_of(build_cache(test::with_normals(fin().mesh), few)), std::invalid_argument);
}

}  // namespace
}  // namespace gliss
