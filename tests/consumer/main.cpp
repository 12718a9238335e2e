// What a program that uses an installed Gliss looks like: a sphere's force 1 mm beneath its
// surface.
#include <cmath>
#include <cstdio>

#include "host/engine.h"
#include "host/generate.h"

int main() {
  const auto engine = gliss::make_tbb_engine();
  const gliss::PatchCache cache = engine->build(gliss::goldberg().mesh);
  const gliss::Contact contact = gliss::nearest(cache, gliss::Vec3(9, 0, 0));
  const gliss::Vec3 force = gliss::force(cache, contact, 500);
  std::printf("force %.3f %.3f %.3f N\n", force.x(), force.y(), force.z());
  return contact.touching && std::abs(force.norm() - 0.5) < 0.05 ? 0 : 1;
}
