#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return gliss::fuzz::read_mesh(gliss::detail::read_stl, gliss::fuzz::text_of(data, size));
}
