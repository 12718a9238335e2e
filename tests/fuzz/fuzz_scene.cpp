// Whatever the text of a scene, beside a mesh and a path: numbers that a loop can use, or an error
// of one line that names the file.
#include "gliss/scene/scene.h"
#include "gliss/tables/csv_reader.h"
#include "tests/fuzz/fuzz.h"

namespace gliss::fuzz {
namespace {

void require_usable(const Scene& scene) {
  for (const ObjectDescription& object : scene.objects) {
    const Eigen::Matrix3d turn = object.pose.linear();
    require(object.pose.matrix().allFinite() && turn.isUnitary(1e-9) && turn.determinant() > 0,
            "a rotation and a finite place");
    require(object.unit > 0 && object.unit < HUGE_VAL, "a unit");
    require(object.stiffness > 0 && object.stiffness < HUGE_VAL, "a stiffness");
  }
  for (const Vec3& hip : scene.hips) require(hip.allFinite(), "finite HIPs");
  require(scene.loop.period.count() > 0, "a period");
  Guard guard(scene.loop.guard);
  if (!scene.sim) return;
  SimDevice device(scene.sim_path, *scene.sim);
  device.read(Nanoseconds(0));
  device.read(std::chrono::milliseconds(1));
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  using fuzz::folder;
  static const std::string mesh = folder().write("ball.obj", "v 0 0 0\n"),
                           cache = folder().write("ball.gliss", "GLS"),
                           table = folder().write("hand.csv", "x,y,z\n0,0,0\n0,0,0.1\n");
  const std::string path = folder().write("scene.toml", std::string(fuzz::text_of(data, size)));
  std::string what;
  try {
    fuzz::require_usable(read_scene(path));
    return 0;
  } catch (const SceneError& error) {
    what = error.what();
    fuzz::require(what.starts_with(path + ":"), "the place named: " + what);
  } catch (const CsvError& error) {
    what = error.what();
  }
  fuzz::require(what.find_first_of("\r\n") == what.npos, "one line: " + what);
  return 0;
}
