// Creases of a scene's objects, and of lazy ones.
#include <gtest/gtest.h>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/lazy/lazy_mesh.h"
#include "gliss/mesh/rounding.h"
#include "gliss/scene/open_scene.h"
#include "gliss/surface/instances.h"
#include "tests/support/scene_files.h"
#include "tests/support/sharp_meshes.h"

namespace gliss::test {
namespace {

TEST(CreaseScene, objects_have_the_creases_that_the_scene_says) {
  const SceneFiles files;
  save_obj(prism(12).mesh, files.folder / "prism.obj");
  files.folder.write("edges.txt", "0 1\n");
  const Scene scene = files.read(
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\ncrease = '40deg,edges:edges.txt'\n"
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\nconstruction = 'fair'\ncrease = '20deg'\n"
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\ncrease = 'none'\n"
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\n");
  EXPECT_NE(std::find(scene.files.begin(), scene.files.end(), files.folder / "edges.txt"),
            scene.files.end());
  const std::vector<SceneObject> objects = open_objects(scene);
  ASSERT_EQ(objects.size(), 4u);
  EXPECT_EQ(objects[0].cache->crease_count, 24u);
  EXPECT_EQ(objects[1].cache->crease_count, 36u);
  EXPECT_EQ(objects[2].cache->crease_count, 0u);
  EXPECT_EQ(objects[3].cache->crease_count, 24u);  // the edges that turn by 90 degrees
}

TEST(CreaseScene, objects_have_the_radius_that_the_scene_says) {
  const SceneFiles files;
  save_obj(prism(12).mesh, files.folder / "prism.obj");
  const Scene scene = files.read(
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\ncrease = '40deg'\nradius = '1mm'\n"
      "[[object]]\nmesh = 'prism.obj'\nunit = 'mm'\ncrease = '40deg'\nradius = '1mm'\n"
      "patches = 'lazy'\n");
  const std::vector<SceneObject> objects = open_objects(scene);
  EXPECT_EQ(objects[0].cache->crease_count, 0u);
  EXPECT_EQ(objects[0].cache->mesh_face_count, 14 + 2 * 24u);
  EXPECT_EQ(objects[1].lazy->base().mesh_hash, objects[0].cache->mesh_hash);
}

TEST(CreaseScene, objects_are_turned_as_the_scene_says) {
  const SceneFiles files;
  Mesh room = goldberg(3, 10).mesh;
  for (std::uint32_t face = 0; face < room.face_count(); ++face)
    std::reverse(room.corner_vertex.begin() + room.face_begin[face],
                 room.corner_vertex.begin() + room.face_begin[face + 1]);
  room.normals.clear(), room.corner_normal.clear();
  save_obj(room, files.folder / "room.obj");
  room.corner_vertex.resize(room.face_begin[40]);
  room.face_begin.resize(41);
  save_obj(room, files.folder / "open.obj");
  const std::vector<SceneObject> objects =
      open_objects(files.read("[[object]]\nmesh = 'room.obj'\nunit = 'mm'\n"
                              "[[object]]\nmesh = 'room.obj'\nunit = 'mm'\norient = 'file'\n"
                              "[[object]]\nmesh = 'open.obj'\nunit = 'mm'\n"
                              "[[object]]\nmesh = 'open.obj'\nunit = 'mm'\nflip = true\n"));
  const auto distance = [&](std::size_t i) {
    const SurfacePoint on = evaluate(*objects[i].cache, {0, 0, 0});
    return nearest(*objects[i].cache, 0.9 * on.position).distance;
  };
  EXPECT_LT(distance(0), -0.5);
  EXPECT_GT(distance(1), 0.5);
  EXPECT_GT(distance(2), 0.5);
  EXPECT_LT(distance(3), -0.5);
}

// What is built near the hand has the bytes that it has in the cache of all.
TEST(CreaseScene, lazy_patches_beside_creases_are_those_of_the_whole) {
  for (const Construction construction : {Construction::kPaper, Construction::kFair}) {
    for (const bool rounds : {false, true}) {
      Mesh mesh = with_creases(in_triangles(cylinder(16, 6).mesh));
      if (rounds) round_creases(mesh, 0.3e-3);
      BuildOptions options;
      options.level.construction = construction;
      const PatchCache all = build_cache(mesh, options);
      const LazyMesh lazy(mesh, {.level = options.level});
      EXPECT_EQ(lazy.base().crease_count, all.crease_count);
      const auto& whole = std::get<1>(all.surface);
      for (const std::uint32_t face : {0u, 40u, 100u, 191u, 200u}) {
        const LazyRegion region = lazy.build(std::vector<std::uint32_t>{face});
        const auto& part = std::get<1>(region.cache.surface);
        for (std::uint32_t p = 0; p < region.cache.patch_count(); ++p) {
          if (!region.used[p]) continue;
          const std::uint32_t q = all.first_patch(region.cache.patch_face[p]) + p -
                                  region.cache.first_patch(region.cache.patch_face[p]);
          const std::size_t reals =
              kernels<double>().control_reals(whole.form[q], whole.valence(q));
          ASSERT_EQ(part.form[p], whole.form[q]);
          EXPECT_TRUE(std::equal(&part.control[3 * std::size_t{part.control_begin[p]}],
                                 &part.control[3 * std::size_t{part.control_begin[p]}] + reals,
                                 &whole.control[3 * std::size_t{whole.control_begin[q]}]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace gliss::test
