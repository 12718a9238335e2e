// A device loop on a cache made in memory, linked with the loop's library and no other: what
// loop_links.sh looks at.
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "gliss/build/build_cache.h"
#include "gliss/device/replay_device.h"
#include "gliss/device/udp_device.h"
#include "gliss/device/udp_server.h"
#include "gliss/generate/generate.h"
#include "gliss/loop/loop.h"
#include "gliss/thread/realtime.h"

int main() {
  using namespace gliss;
  const auto cache = std::make_shared<const PatchCache>(build_cache(goldberg().mesh));
  const SceneObject object{.cache = cache};
  Tracker tracker({&object, 1});
  ReplayDevice device(std::vector<Vec3>(20, {0.009, 0, 0}));
  HapticLoop loop(device, tracker, {.wait = false});
  Vec3 felt = Vec3::Zero();
  loop.run([&](const LoopTick& tick) {
    felt = tick.rendered;
    return true;
  });
  std::printf("%.3f N after %d ticks\n", felt.norm(), static_cast<int>(loop.record().ticks()));
  return std::abs(felt.norm() - 0.5) < 0.05 ? 0 : 1;
}
