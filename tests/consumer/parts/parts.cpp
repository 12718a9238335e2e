#include <gliss/gliss.h>
#include <cstdio>

int main() {
  const gliss::PatchCache cache = gliss::build_cache(gliss::goldberg().mesh);
  const gliss::Contact contact = gliss::nearest(cache, gliss::Vec3(9, 0, 0));
  std::printf("%g mm\n", contact.distance);
  return contact.touching ? 0 : 1;
}
