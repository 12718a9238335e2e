// The worker that builds patches and the tick that follows a contact, under ThreadSanitizer: what
// they hand each other, and the arrays in it that this program writes and reads itself.
#include <chrono>
#include <cstdio>
#include <thread>

#include "gliss/contact/lazy_contact.h"
#include "gliss/generate/generate.h"

int main() {
  using namespace gliss;
  const Generated knot = torus_knot();
  const auto mesh = std::make_shared<const LazyMesh>(knot.mesh);
  std::uint64_t late = 0;
  for (int round = 0; round < 20; ++round) {
    LazyWorkerOptions options;
    options.poll = std::chrono::microseconds(50);
    LazyContact contact(mesh, {}, options);
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    // The HIP goes to and fro, so that the worker has a second region to build, however slow it is.
    for (int i = 0; i < 300 || contact.worker().regions() < 2; ++i) {
      const double height = 0.1 * (i % 600 < 300 ? i % 600 : 600 - i % 600);
      const auto p = knot.exact->nearest(knot.mesh.positions[0] + Vec3(0, 0, height));
      const Vec3 hip = p.position - 2 * p.normal;
      contact.post(hip);
      late += (contact.tick(hip).flags & kNotBuilt) != 0;
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      if (std::chrono::steady_clock::now() > give_up) {
        std::printf("round %d: no second region within a minute\n", round);
        return 1;
      }
    }
  }
  std::printf("%llu ticks without patches\n", static_cast<unsigned long long>(late));
}
