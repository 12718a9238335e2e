// Whatever a cache file holds, under checksums that are right or wrong: a cache that queries can
// walk, whatever they find, or a CacheError.
#include "gliss/files/cache_file.h"
#include "gliss/files/cache_format.h"
#include "gliss/query/contact_tracker.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/small_caches.h"

namespace gliss::fuzz {
namespace {

template <class Array>
void edit_array(Array& values, Input& input) {
  if (input.flag() || values.empty()) {
    values.resize(std::max<std::size_t>(values.size() + input.choice(16), 8) - 8);
  } else {
    values[input.number<std::uint32_t>() % values.size()] =
        input.number<typename Array::value_type>();
  }
}

void edit_number(PatchCache& cache, Input& input) {
  switch (input.choice(6)) {
    case 0:
      cache.unit = input.number<double>();
      break;
    case 1:
      cache.origin[static_cast<int>(input.choice(3))] = input.number<double>();
      break;
    case 2:
      cache.scale = input.number<double>();
      break;
    case 3:
      cache.level.kind = static_cast<Level::Kind>(input.byte());
      break;
    case 4:
      cache.level.cells = input.byte();
      break;
    default:
      cache.mesh_face_count = input.byte();
  }
}

// An array, or a number of the header.
void edit(PatchCache& cache, Input& input) {
  const unsigned chosen = input.choice(cache_format::kSections + 1);
  if (chosen == cache_format::kSections) return edit_number(cache, input);
  unsigned section = 0;
  cache_format::for_each_section(cache, [&](const char*, auto& values) {
    if (section++ == chosen) edit_array(values, input);
  });
}

// The file as the program writes it, then bytes of it as anything.
void write_file(Input& input, const std::string& path) {
  static const std::vector<PatchCache> kCaches = small_caches();
  const unsigned chosen = input.choice(static_cast<unsigned>(kCaches.size()) + 1);
  if (chosen == kCaches.size()) {
    folder().write("cache", std::string(input.rest()));
    return;
  }
  PatchCache cache = kCaches[chosen];
  const unsigned edits = input.choice(8), bytes = input.choice(4);
  for (unsigned i = 0; i < edits; ++i) edit(cache, input);
  save_cache(cache, path);
  if (bytes == 0) return;
  std::string file = folder().read("cache");
  for (unsigned i = 0; i < bytes; ++i) {
    const std::size_t at = input.number<std::uint32_t>() % file.size();
    file[at] = static_cast<char>(input.byte());
  }
  folder().write("cache", file);
}

void query(const PatchCache& cache) {
  const std::uint32_t face = cache.patch_face[0];
  for (const DomainPoint& at : {DomainPoint{face, 0, 0}, DomainPoint{face, 0.3, -0.2}}) {
    if (in_domain(cache, at)) evaluate(cache, at);
  }
  for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat}) {
    ContactTracker tracker(cache, {{}, method});
    for (const Vec3& hip : {Vec3(0, 0, 1), Vec3(0.2, 0.2, 0.1), Vec3(0.3, 0.3, -0.1)}) {
      nearest(cache, hip, {{}, method});
      tracker.tick(hip);
    }
    tracker.track(Vec3(1, 1, 1), {face, 0, 0});
  }
}

}  // namespace
}  // namespace gliss::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace gliss;
  const std::string path = fuzz::folder() / "cache";
  fuzz::Input input(data, size);
  fuzz::write_file(input, path);
  try {
    fuzz::query(load_cache(path));
  } catch (const CacheError& error) {
    fuzz::require(std::string_view(error.what()).starts_with(path + ": "), "the file named");
  }
  return 0;
}
