// Scenes in a folder of their own, beside files that they may name.
#pragma once

#include <string>

#include "gliss/mesh/mesh.h"
#include "gliss/scene/scene.h"
#include "tests/support/scratch_folder.h"

namespace gliss::test {

struct SceneFiles {
  // To read a scene the files need only be there.
  SceneFiles() {
    folder.write("ball.obj", "");
    folder.write("ball.gliss", "");
    folder.write("back.csv", "t,x,y,z\n1,0,0,0\n0,0,0,0\n");
    folder.write("long.csv", "t,x,y,z,qw,qx,qy,qz\n0,0,0,0,2,0,0,0\n");
    folder.write("half.csv", "t,x,y,z,qw,qx\n0,0,0,0,1,0\n");
    folder.write("path.csv", "x,y,z\n0,0,0.02\n0,0,0.01\n");
  }
  Scene read(const std::string& text) const { return read_scene(folder.write("scene.toml", text)); }
  // what() without the folder: "scene.toml:3: ..."; empty where the scene can be read.
  std::string error_of(const std::string& text) const {
    std::string error = message_of<SceneError>([&] { read(text); });
    const auto at = error.find(folder / "");
    return at == 0 ? error.substr((folder / "").size()) : error;
  }

  const ScratchFolder folder;
};

}  // namespace gliss::test
