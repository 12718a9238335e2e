// A program that uses an installed Gliss: a sphere's force 1 mm beneath its surface, as a question
// and in a loop; two spheres under one hand; and a scene file. Prints the forces to the last bit.
#include <cmath>
#include <cstdio>
#include <fstream>

#include <gliss/gliss.h>

namespace {

using Ball = std::shared_ptr<const gliss::PatchCache>;

void print(const char* what, const gliss::Vec3& v) {
  std::printf("%s %.3f %.3f %.3f (%a %a %a)\n", what, v.x(), v.y(), v.z(), v.x(), v.y(), v.z());
}

// Whoever compiles them, these types are the same.
template <class... Types>
void print_sizes() {
  std::printf("sizes and alignments");
  (std::printf(" %zu/%zu", sizeof(Types), alignof(Types)), ...);
  std::printf("\n");
}

// True if a loop renders the force that a question gives.
bool feels_one_ball(const Ball& cache) {
  const gliss::Contact contact = gliss::nearest(*cache, gliss::Vec3(9, 0, 0));
  const gliss::Vec3 force = gliss::contact_force(*cache, contact, 500);
  print("one ball, N", force);

  gliss::ReplayDevice device(std::vector<gliss::Vec3>(20, {0.009, 0, 0}));
  const gliss::SceneObject object{.cache = cache};
  gliss::Tracker tracker({&object, 1});
  gliss::HapticLoop loop(device, tracker);
  gliss::Vec3 felt;
  loop.run([&](const gliss::LoopTick& tick) {
    felt = tick.rendered;
    return true;
  });
  const bool same = loop.record().ticks() == 20 && (felt - force).norm() < 1e-6;
  return contact.touching && std::abs(force.norm() - 0.5) < 0.05 && same;
}

// True if a hand that comes down between two balls feels both.
bool feels_two_balls(const Ball& cache) {
  std::vector<gliss::SceneObject> objects(2);
  for (gliss::SceneObject& object : objects) object.cache = cache;
  objects[0].pose.translation() << 0.006, 0, 0;
  objects[0].pose.linear() << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
  objects[1].pose.translation() << -0.006, 0, 0;
  objects[1].stiffness = 300;
  gliss::Tracker tracker(objects);
  gliss::Vec3 force;
  for (const double y : {0.02, 0.01, 0.007, 0.005, 0.004}) {
    force = tracker.step({0.0005, y, 0.0002});
    print("two balls, N", force);
  }
  return force.y() > 0.1 && tracker.objects()[0].contact.touching &&
         tracker.objects()[1].contact.touching;
}

// True if a scene's objects are what its file says.
bool reads_a_scene(const gliss::Mesh& mesh) {
  gliss::save_obj(mesh, "ball.obj");
  std::ofstream("balls.toml") << "[[object]]\nmesh = 'ball.obj'\nposition = [0.008, 0, 0]\n"
                                 "[[object]]\nmesh = 'ball.obj'\nposition = [-0.008, 0, 0]\n";
  const gliss::Scene scene = gliss::read_scene("balls.toml");
  if (scene.objects.size() != 2) return false;
  print("second ball, m", scene.objects[1].pose.translation());
  return scene.objects[1].name == "2" && scene.objects[1].pose.translation().x() == -0.008;
}

}  // namespace

int main() {
  using namespace gliss;
  print_sizes<Vec3, Mesh, PatchCache, Box, DomainPoint, SurfacePoint, Contact, ContactTracker,
              TraceStep, SweepBlock, SweepStatistics, LazyMesh, LazyContact>();
  print_sizes<Pose, SceneObject, ObjectStep, Tracker, DeviceInfo, DeviceState, Guard, GuardInput,
              LoopOptions, LoopTick, HapticLoop, ObjectDescription, Scene, SimDevice, ReplayDevice,
              HaplyOptions, UdpServer, LoopSession>();
  const Mesh mesh = goldberg().mesh;
  const Ball cache = std::make_shared<const PatchCache>(make_tbb_engine()->build(mesh));
  return feels_one_ball(cache) && feels_two_balls(cache) && reads_a_scene(mesh) ? 0 : 1;
}
