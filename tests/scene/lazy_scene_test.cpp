// The keys of a scene that say which patches are built.
#include "gliss/scene/scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "gliss/scene/open_scene.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

class LazyScene : public ::testing::Test {
 protected:
  LazyScene() {
    folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("a.gliss", "a cache");
  }
  Scene read(const std::string& keys) {
    return read_scene(folder_.write("scene.toml", "[[object]]\nname = \"a\"\n" + keys));
  }
  std::string refusal(const std::string& keys) {
    const std::string what = test::message_of<SceneError>([&] { read(keys); });
    return what.substr(std::min(what.size(), what.find("scene.toml")));
  }
  test::ScratchFolder folder_;
};

TEST_F(LazyScene, builds_all_patches_where_it_says_nothing) {
  EXPECT_EQ(read("mesh = \"a.obj\"\n").objects[0].patches, Patches::kAll);
  EXPECT_EQ(read("mesh = \"a.obj\"\npatches = \"all\"\n").objects[0].patches, Patches::kAll);
}

TEST_F(LazyScene, says_how_many_rings) {
  const Scene scene = read("mesh = \"a.obj\"\npatches = \"lazy\"\nrings = 5\n");
  EXPECT_EQ(scene.objects[0].patches, Patches::kLazy);
  EXPECT_EQ(scene.objects[0].rings, 5);
  EXPECT_EQ(read("mesh = \"a.obj\"\npatches = \"lazy\"\n").objects[0].rings, 3);
}

TEST_F(LazyScene, names_line_and_key_of_what_does_not_go_together) {
  EXPECT_EQ(refusal("cache = \"a.gliss\"\npatches = \"lazy\"\n"),
            "scene.toml:4: object.patches: a cache has its patches; lazy needs a mesh");
  EXPECT_EQ(refusal("mesh = \"a.obj\"\npatches = \"lazy\"\nmethod = \"flat\"\n"),
            "scene.toml:4: object.patches: lazy is for the method gregory; the others need no "
            "patches");
  EXPECT_EQ(refusal("mesh = \"a.obj\"\nrings = 3\n"),
            "scene.toml:4: object.rings: goes with patches = \"lazy\"");
  EXPECT_EQ(refusal("mesh = \"a.obj\"\npatches = \"some\"\n"),
            "scene.toml:4: object.patches: 'some' is not one of all, lazy");
  EXPECT_TRUE(refusal("mesh = \"a.obj\"\npatches = \"lazy\"\nrings = 1\n")
                  .starts_with("scene.toml:5: object.rings"));
}

TEST_F(LazyScene, builds_all_patches_where_one_part_lies_within_another) {
  std::string shells[3];  // a cube, a mirrored one within it and so a cavity, a solid across that
  int first = 1;
  for (const double half : {2.0, -1.0, 1.5}) {
    std::string& shell = shells[first / 8];
    for (int i = 0; i < 8; ++i)
      shell += fmt::format("v {} {} {}\n", i & 1 ? half : -half, i & 2 ? half : -half,
                           i & 4 ? half : -half);
    for (const char* face : {"0231", "4576", "0154", "2673", "0462", "1375"})
      shell += fmt::format("f {} {} {} {}\n", face[0] - '0' + first, face[1] - '0' + first,
                           face[2] - '0' + first, face[3] - '0' + first);
    first += 8;
  }
  const auto opened = [&](const std::string& mesh) {
    folder_.write("b.obj", mesh);
    return open_objects(read("mesh = \"b.obj\"\npatches = \"lazy\"\n")).at(0);
  };
  for (const std::string& mesh : {shells[0], shells[0] + shells[1]}) {
    const SceneObject object = opened(mesh);
    EXPECT_TRUE(object.lazy != nullptr && object.cache == nullptr);
  }
  const SceneObject crossed = opened(shells[0] + shells[1] + shells[2]);
  EXPECT_TRUE(crossed.lazy == nullptr && crossed.cache != nullptr);
}

}  // namespace
}  // namespace gliss
