// The numbers of caches and contacts, to the last bit, against those of this revision.
#include <gtest/gtest.h>

#include <sstream>

#include "gliss/build/build_cache.h"
#include "gliss/files/cache_format.h"
#include "gliss/generate/generate.h"
#include "gliss/query/query.h"
#include "gliss/surface/names.h"
#include "gliss/surface/revision.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

class Digest {
 public:
  void add(const void* data, std::size_t bytes) {
    const std::uint64_t both[] = {value_, cache_format::checksum(data, bytes)};
    value_ = cache_format::checksum(both, sizeof(both));
  }
  void add(const PatchCache& cache) {
    cache_format::for_each_section(cache, [&](const char*, const auto& values) {
      add(values.data(), values.size() * sizeof(values[0]));
    });
  }
  void add(const Contact& contact) {
    add(contact.scp.data(), sizeof(contact.scp));
    add(contact.push.data(), sizeof(contact.push));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0;
};

// A change in how contacts are sought, which leaves caches as they are, fails the second alone.
TEST(Revision, changes_where_numbers_do) {
  Digest caches, contacts;
  for (const Generated& made : {goldberg(2), fin(), prism(5), torus(8, 6)}) {
    for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
      for (const char* name : {"exact", "ribbon", "bezier", "table:1", "fair", "fair-table:1"}) {
        const Level level = find_surface(name).value();
        const PatchCache cache = build_cache(made.mesh, {.precision = precision, .level = level});
        caches.add(cache);
        for (const Method method : {Method::kGregory, Method::kShaded, Method::kFlat})
          contacts.add(nearest(cache, {3, 1, 0.5}, {{}, method}));
      }
    }
  }
  const auto told = [](const char* what, const Digest& digest) {
    std::ostringstream text;
    text << "raise kNumbersRevision, now " << kNumbersRevision << "; " << what << ": 0x" << std::hex
         << digest.value();
    return text.str();
  };
  EXPECT_EQ(caches.value(), 0x63698503ae033108u) << told("caches", caches);
  EXPECT_EQ(contacts.value(), 0x784833a633ccfb35u) << told("contacts", contacts);
}

// Boxes, tiles and searches may change with releases; the control data of the paper's patches do
// not.
TEST(Revision, leaves_the_patches_of_the_paper_alone) {
  Digest digest;
  const Level paper = find_surface("exact").value();
  for (const Generated& made : {goldberg(2), fin(), prism(5), torus(8, 6)}) {
    for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
      const PatchCache cache =
          test::unlimited_cache(made.mesh, {.precision = precision, .level = paper});
      std::visit(
          [&](const auto& s) {
            digest.add(s.control.data(), s.control.size() * sizeof(s.control[0]));
          },
          cache.surface);
    }
  }
  EXPECT_EQ(digest.value(), 0x3faff7603f208725u) << std::hex << digest.value();
}

}  // namespace
}  // namespace gliss
