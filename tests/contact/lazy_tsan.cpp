// The worker that builds patches and the tick that follows a contact, under ThreadSanitizer: what
// they hand each other, and the arrays in it that this program writes and reads itself.
#include <cstdio>

#include "gliss/contact/lazy_contact.h"
#include "gliss/generate/generate.h"

int main() {
  using namespace gliss;
  const Generated knot = torus_knot();
  const auto mesh = std::make_shared<const LazyMesh>(knot.mesh);
  std::uint64_t regions = 0, late = 0;
  for (int round = 0; round < 20; ++round) {
    LazyWorkerOptions options;
    options.poll = std::chrono::microseconds(50);
    LazyContact contact(mesh, {}, options);
    for (int i = 0; i < 300; ++i) {
      const auto p = knot.exact->nearest(knot.mesh.positions[0] + Vec3(0, 0, 0.1 * i));
      const Vec3 hip = p.position - 2 * p.normal;
      contact.post(hip);
      late += (contact.tick(hip).flags & kNotBuilt) != 0;
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    regions += contact.worker().regions();
  }
  std::printf("%d regions, %d ticks without\n", static_cast<int>(regions), static_cast<int>(late));
  return regions > 20 ? 0 : 1;
}
