// What a program that uses an installed Gliss looks like: a sphere's force 1 mm beneath its
// surface, as a question and in a loop.
#include <cmath>
#include <cstdio>

#include "host/engine.h"
#include "host/generate.h"
#include "runtime/loop.h"
#include "runtime/replay_device.h"

int main() {
  const auto engine = gliss::make_tbb_engine();
  const auto cache =
      std::make_shared<const gliss::PatchCache>(engine->build(gliss::goldberg().mesh));
  const gliss::Contact contact = gliss::nearest(*cache, gliss::Vec3(9, 0, 0));
  const gliss::Vec3 force = gliss::force(*cache, contact, 500);
  std::printf("force %.3f %.3f %.3f N\n", force.x(), force.y(), force.z());

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
  return contact.touching && std::abs(force.norm() - 0.5) < 0.05 && same ? 0 : 1;
}
