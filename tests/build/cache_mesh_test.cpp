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

TEST(CacheMesh, is_not_to_be_had_of_creases_and_of_single_faces) {
  const PatchCache creased = test::cache_of(test::with_creases(test::cube()));
  EXPECT_THROW(mesh_of(creased), std::invalid_argument);
  BuildOptions few;
  few.faces = {0, 1};
  EXPECT_THROW(mesh_of(build_cache(test::with_normals(fin().mesh), few)), std::invalid_argument);
}

}  // namespace
}  // namespace gliss
