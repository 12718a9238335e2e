// The keys of a scene that say which patches are built.
#include "gliss/scene/scene.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace gliss
