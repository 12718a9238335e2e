// The cache file: what is loaded is what was saved, bit by bit; everything else is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <limits>
#include <system_error>
#include <thread>

#include "gliss/build/build_cache.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/cache_format.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/numbers.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using test::kInfinity, test::kNaN;

using namespace cache_format;
using test::ScratchFolder;

using ::testing::HasSubstr;
using ::testing::StartsWith;

Mesh polygon(std::vector<Vec3> corners) {
  Mesh mesh;
  mesh.unit = 1e-3;
  for (std::uint32_t v = 0; v < corners.size(); ++v) mesh.corner_vertex.push_back(v);
  mesh.face_begin.push_back(static_cast<std::uint32_t>(corners.size()));
  mesh.positions = std::move(corners);
  return mesh;
}

BuildOptions in(Precision precision, bool tame = true, std::vector<std::uint32_t> faces = {}) {
  return {.precision = precision, .tame = tame, .faces = std::move(faces)};
}

PatchCache triangle_cache(Precision precision = Precision::kFloat) {
  return build_cache(polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}), in(precision));
}

PatchCache paper_torus() {
  BuildOptions options;
  options.level.construction = Construction::kPaper;
  return build_cache(torus(6, 4).mesh, options);
}

// Its reflex corner makes the exact patch fold, so that it is cut.
PatchCache dart_cache(Precision precision = Precision::kDouble) {
  return build_cache(polygon({{0, 0, 0}, {3, -2, 0.3}, {0.4, 0, 0}, {3, 2, 0.3}}), in(precision));
}

// Obtuse faces, which are cut round a centre.
PatchCache fan_cache() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {10, 0, 0}, {-3, 1, 0}, {4, 0.5, -3}};
  mesh.corner_vertex = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  mesh.face_begin = {0, 3, 6, 9, 12};
  return build_cache(mesh, in(Precision::kDouble));
}

template <class Real>
auto arrays_of(const Surface<Real>& s) {
  return std::tie(s.domain, s.domain_begin, s.side_begin, s.side_patch, s.side_twin, s.control,
                  s.control_begin, s.form, s.corner, s.patch, s.triangle, s.node, s.child, s.tile,
                  s.tile_begin, s.part, s.part_table, s.partner, s.part_box);
}
auto fields_of(const PatchCache& c) {
  return std::tie(c.unit, c.origin, c.scale, c.mesh_face_count, c.mesh_hash, c.patch_face,
                  c.face_patch, c.kind, c.folded, c.rho_min, c.corner_of_face, c.face_valence);
}
bool equal(const PatchCache& a, const PatchCache& b) {
  return fields_of(a) == fields_of(b) && a.precision() == b.precision() &&
         std::visit(
             [&]<class Real>(const Surface<Real>& s) {
               return arrays_of(s) == arrays_of(std::get<Surface<Real>>(b.surface));
             },
             a.surface);
}

PatchCache saved_and_loaded(const PatchCache& cache) {
  const ScratchFolder folder;
  save_cache(cache, folder / "scene.gliss");
  EXPECT_EQ(folder.file_count(), 1u);
  EXPECT_TRUE(is_cache_file(folder / "scene.gliss"));
  return load_cache(folder / "scene.gliss");
}

void expect_same_contact(const Contact& a, const Contact& b) {
  const auto fields = [](const Contact& c) {
    return std::tie(c.touching, c.at.face, c.at.xi, c.at.eta, c.scp, c.normal, c.distance, c.push,
                    c.residual_angle, c.iterations, c.crossings, c.flags);
  };
  EXPECT_TRUE(fields(a) == fields(b));
}

void expect_same_answers(const PatchCache& a, const PatchCache& b) {
  const Box box = a.bounds();
  ContactTracker tracker_a(a, {}), tracker_b(b, {});
  for (int i = 0; i < 50; ++i) {
    const Vec3 mix(0.02 * i, 0.5 + 0.4 * std::sin(i), 0.5 + 0.6 * std::cos(2 * i));
    const Vec3 hip = box.low + mix.cwiseProduct(box.high - box.low);
    expect_same_contact(nearest(a, hip), nearest(b, hip));
    expect_same_contact(tracker_a.tick(hip), tracker_b.tick(hip));
    const DomainPoint point{a.patch_face[static_cast<std::size_t>(i) % a.patch_count()],
                            0.3 * std::sin(i), 0.3 * std::cos(i)};
    const SurfacePoint pa = evaluate(a, point), pb = evaluate(b, point);
    EXPECT_TRUE(std::tie(pa.position, pa.d_xi, pa.d_eta, pa.normal) ==
                std::tie(pb.position, pb.d_xi, pb.d_eta, pb.normal));
  }
}

TEST(CacheFile, of_a_region_of_a_mesh_lists_all_faces) {
  const Mesh mesh = torus().mesh;
  const PatchCache whole = build_cache(mesh);
  BuildOptions options;
  options.faces = {5, 6, 7, 100, 287};
  options.like = &whole;
  const PatchCache region = build_cache(mesh, options), loaded = saved_and_loaded(region);
  ASSERT_EQ(loaded.face_patch.size(), mesh.face_count());
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
    EXPECT_EQ(loaded.face_patch[face], region.first_patch(face));
}

class CacheFileOfPrecision : public ::testing::TestWithParam<Precision> {};
INSTANTIATE_TEST_SUITE_P(CacheFile, CacheFileOfPrecision,
                         ::testing::Values(Precision::kFloat, Precision::kDouble));

TEST_P(CacheFileOfPrecision, KeepsEveryBit) {
  const auto check = [](const PatchCache& cache) {
    const PatchCache loaded = saved_and_loaded(cache);
    EXPECT_TRUE(equal(cache, loaded));
    EXPECT_EQ(cache.bytes(), loaded.bytes());
    expect_same_answers(cache, loaded);
  };
  check(triangle_cache(GetParam()));
  check(build_cache(torus_knot().mesh, in(GetParam())));
  check(build_cache(goldberg().mesh, in(GetParam())));
  check(build_cache(prism(120).mesh, in(GetParam())));
  check(build_cache(fin().mesh, in(GetParam())));
  check(build_cache(fin().mesh, in(GetParam(), false)));
  check(build_cache(torus().mesh, in(GetParam(), true, {5, 6, 7, 100, 287})));
  const PatchCache dart = dart_cache(GetParam());
  EXPECT_GT(dart.patch_count(), 1u);
  check(dart);
}

TEST(CacheFile, SameCacheSameBytes) {
  const ScratchFolder folder;
  save_cache(dart_cache(), folder / "a");
  save_cache(load_cache(folder / "a"), folder / "b");
  EXPECT_EQ(folder.read("a"), folder.read("b"));
  const PatchCache cache = dart_cache();
  EXPECT_EQ(folder.read("a").size(), kHeaderBytes + cache.bytes() - cache.open.size());
}

// The error of a file that load_cache must refuse.
CacheError refused(const std::string& path) {
  try {
    load_cache(path);
  } catch (const CacheError& error) {
    return error;
  }
  return {"was loaded", false};
}
std::string refusal(const std::string& path) { return refused(path).what(); }

// Wherever the writing ends, what was there before stays.
TEST(CacheFile, IsAsBeforeWhereWritingIsEnded) {
  const ScratchFolder folder;
  int asked = 0, last = 0;
  const auto poll = [&] {
    if (++asked == last) throw std::runtime_error("ended");
  };
  save_cache(triangle_cache(), folder / "whole", poll);
  const int all = std::exchange(asked, 0);
  EXPECT_GT(all, 10);
  const std::string path = folder.write("scene.gliss", "before");
  for (last = 1; last <= all; ++last, asked = 0) {
    EXPECT_THROW(save_cache(triangle_cache(), path, poll), std::runtime_error);
    EXPECT_EQ(folder.read("scene.gliss"), "before");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), 2);
}

TEST(CacheFile, EveryTruncationIsRefused) {
  const ScratchFolder folder;
  const std::string path = folder / "scene.gliss";
  save_cache(triangle_cache(), path);
  for (std::size_t size = std::filesystem::file_size(path); size-- > 0;) {
    std::filesystem::resize_file(path, size);
    ASSERT_THAT(refusal(path), StartsWith(path + ": ")) << size;
  }
}

TEST(CacheFile, MoreBytesAreRefused) {
  const ScratchFolder folder;
  save_cache(triangle_cache(), folder / "scene.gliss");
  const std::string bytes = folder.read("scene.gliss");
  EXPECT_THAT(refusal(folder.write("long", bytes + '\0')), HasSubstr(" bytes where "));
}

TEST(CacheFile, EveryFlippedBitIsRefused) {
  const ScratchFolder folder;
  const std::string path = folder / "scene.gliss";
  save_cache(triangle_cache(), path);
  const std::string bytes = folder.read("scene.gliss");
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](std::size_t at, char byte) {
    file.seekp(static_cast<std::streamoff>(at)).put(byte).flush();
  };
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      put(at, static_cast<char>(bytes[at] ^ (1 << bit)));
      ASSERT_THAT(refusal(path), StartsWith(path + ": ")) << at << " bit " << bit;
      ASSERT_FALSE(refused(path).stale) << at << " bit " << bit;
    }
    put(at, bytes[at]);
  }
  EXPECT_TRUE(equal(load_cache(path), triangle_cache()));
}

// A cache file in memory whose parts can be changed under checksums that stay right.
class Forgery {
 public:
  explicit Forgery(const PatchCache& cache) {
    save_cache(cache, folder_ / "sound");
    bytes_ = folder_.read("sound");
  }

  template <class T>
  Forgery& set(const std::string& section, std::size_t index, T value) {
    Section entry = section_named(section);
    EXPECT_EQ(entry.element_bytes, sizeof(T));
    EXPECT_LT(index, entry.count);
    put(entry.offset + index * sizeof(T), value);
    return *this;
  }
  template <class Change>
  Forgery& change_header(const Change& change) {
    Header header = header_now();
    change(header);
    put(0, header);
    return *this;
  }
  template <class Change>
  Forgery& change_section(const std::string& name, const Change& change) {
    Section entry = section_named(name);
    change(entry);
    put(place_of(name), entry);
    return *this;
  }

  CacheError refusal() {
    for (std::size_t place = sizeof(Header); place < kHeaderBytes; place += sizeof(Section)) {
      Section entry = get<Section>(place);
      const std::size_t size = entry.count * entry.element_bytes;
      if (entry.offset > bytes_.size() || size > bytes_.size() - entry.offset) continue;
      entry.checksum = checksum(&bytes_[entry.offset], size);
      put(place, entry);
    }
    change_header([&](Header& h) {
      h.checksum = checksum(&bytes_[kChecksumBegin], h.header_bytes - kChecksumBegin);
    });
    return refused(folder_.write("forged", bytes_));
  }
  std::string what() { return refusal().what(); }

 private:
  template <class T>
  T get(std::size_t place) const {
    T value;
    std::memcpy(&value, &bytes_.at(place), sizeof(T));
    return value;
  }
  template <class T>
  void put(std::size_t place, const T& value) {
    std::memcpy(&bytes_.at(place), &value, sizeof(T));
  }
  Header header_now() const { return get<Header>(0); }
  std::size_t place_of(const std::string& name) const {
    std::size_t place = sizeof(Header);
    while (get<Section>(place).name != name) place += sizeof(Section);
    return place;
  }
  Section section_named(const std::string& name) const { return get<Section>(place_of(name)); }

  const ScratchFolder folder_;
  std::string bytes_;
};

TEST(CacheFile, ForeignFilesAreToldApart) {
  const ScratchFolder folder;
  const std::string path = folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_FALSE(is_cache_file(path));
  EXPECT_EQ(refusal(path), path + ": not a gliss cache, or changed by a transfer as text");
  const std::string empty = folder.write("empty", "");
  EXPECT_FALSE(is_cache_file(empty));
  EXPECT_THAT(refusal(empty), HasSubstr("not a gliss cache"));
  EXPECT_FALSE(is_cache_file(folder / "missing"));
  EXPECT_FALSE(is_cache_file(folder / ""));

  save_cache(triangle_cache(), folder / "scene.gliss");
  std::string text = folder.read("scene.gliss");
  std::erase(text, '\r');
  const std::string as_text = folder.write("as_text", text);
  EXPECT_TRUE(is_cache_file(as_text));  // so that it is not taken for a mesh
  EXPECT_THAT(refusal(as_text), HasSubstr("transfer as text"));
}

TEST(CacheFile, WhatCannotBeOpenedIsNamed) {
  const ScratchFolder folder;
  const auto error = [](const std::string& path) {
    return test::message_of<std::system_error>([&] { load_cache(path); });
  };
  EXPECT_EQ(error(folder / "none"),
            "cannot read '" + (folder / "none") + "': No such file or directory");
  EXPECT_THAT(error(folder / ""), HasSubstr("Is a directory"));
}

TEST(CacheFile, OtherReleasesAreAsGood) {
  EXPECT_STREQ(Forgery(triangle_cache())
                   .change_header([](Header& h) { h.gliss_version[0] = '9'; })
                   .refusal()
                   .what(),
               "was loaded");
}

TEST(CacheFile, OtherVersionsAreStaleAndNotDamaged) {
  const auto stale = [](auto change) {
    const CacheError error = Forgery(triangle_cache()).change_header(change).refusal();
    EXPECT_TRUE(error.stale) << error.what();
    return std::string(error.what());
  };
  EXPECT_THAT(stale([](Header& h) { h.format = kFormat + 1; }),
              HasSubstr(fmt::format("of format {}, this program reads {}", kFormat + 1, kFormat)));
  EXPECT_THAT(stale([](Header& h) {
                h.gliss_version[0] = '9';
                ++h.numbers_revision;
              }),
              HasSubstr("built by gliss 9."));
  EXPECT_THAT(stale([](Header& h) { ++h.side_reals; }), HasSubstr("another build"));
  EXPECT_THAT(stale([](Header& h) { ++h.patch_reals; }), HasSubstr("another build"));
}

// The file that a machine of the other byte order would write: each number, and each checksum of
// what is then in the file.
std::string in_other_byte_order(std::string bytes) {
  const auto swap = [&](std::size_t at, std::size_t size) {
    std::reverse(&bytes.at(at), &bytes.at(at) + size);
  };
  const auto put_checksum = [&](std::size_t at, std::size_t begin, std::size_t size) {
    const std::uint64_t sum = checksum(bytes.data() + begin, size);
    std::memcpy(&bytes.at(at), &sum, sizeof sum);
    swap(at, sizeof sum);
  };
  for (std::size_t place = sizeof(Header); place < kHeaderBytes; place += sizeof(Section)) {
    Section entry;
    std::memcpy(&entry, &bytes.at(place), sizeof entry);
    for (std::size_t i = 0; i < entry.count; ++i) {
      swap(entry.offset + i * entry.element_bytes, entry.element_bytes);
    }
    for (const std::size_t at : {offsetof(Section, count), offsetof(Section, offset)}) {
      swap(place + at, 8);
    }
    for (const std::size_t at : {offsetof(Section, element), offsetof(Section, element_bytes)}) {
      swap(place + at, 4);
    }
    put_checksum(place + offsetof(Section, checksum), entry.offset,
                 entry.count * entry.element_bytes);
  }
  swap(offsetof(Header, file_bytes), 8);
  for (std::size_t at = offsetof(Header, byte_order); at < offsetof(Header, gliss_version); at += 4)
    swap(at, 4);
  for (std::size_t at = offsetof(Header, side_reals); at < offsetof(Header, mesh_hash); at += 4)
    swap(at, 4);
  for (std::size_t at = offsetof(Header, mesh_hash); at < sizeof(Header); at += 8) swap(at, 8);
  put_checksum(offsetof(Header, checksum), kChecksumBegin, kHeaderBytes - kChecksumBegin);
  return bytes;
}

TEST(CacheFile, TheOtherByteOrderIsNamed) {
  const ScratchFolder folder;
  const std::string path = folder / "scene.gliss";
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    save_cache(dart_cache(precision), path);
    const std::string bytes = folder.read("scene.gliss");
    const std::string swapped = in_other_byte_order(bytes);
    folder.write("scene.gliss", swapped);
    EXPECT_TRUE(is_cache_file(path));  // so that it is not taken for a mesh
    const CacheError error = refused(path);
    EXPECT_TRUE(error.stale);
    EXPECT_EQ(error.what(),
              path + ": written by a machine of the other byte order; build it again");

    // All of it was swapped: the byte order alone, put right, leaves a file that is refused.
    std::string marked = swapped;
    std::memcpy(&marked[offsetof(Header, byte_order)], &bytes[offsetof(Header, byte_order)], 4);
    EXPECT_FALSE(refused(folder.write("scene.gliss", marked)).stale);
  }
}

TEST(CacheFile, HeadersThatLieAreRefused) {
  const auto header = [](auto change) {
    const CacheError error = Forgery(triangle_cache()).change_header(change).refusal();
    EXPECT_FALSE(error.stale);
    return std::string(error.what());
  };
  EXPECT_THAT(header([](Header& h) { h.precision = 2; }), HasSubstr("unknown precision"));
  EXPECT_THAT(header([](Header& h) { h.level = 4; }), HasSubstr("unknown level"));
  EXPECT_THAT(header([](Header& h) { h.construction = 2; }), HasSubstr("unknown level"));
  EXPECT_THAT(header([](Header& h) { h.creases = 2; }), HasSubstr("more creases than edges"));
  EXPECT_THAT(header([](Header& h) { h.table_cells = 4; }), HasSubstr("unknown level"));
  EXPECT_THAT(header([](Header& h) { h.level = Level::kTable; }), HasSubstr("unknown level"));
  EXPECT_THAT(header([](Header& h) { h.precision = 1; }), HasSubstr("'domain': its entry"));
  EXPECT_THAT(header([](Header& h) { --h.section_count; }), HasSubstr("its size is wrong"));
  EXPECT_THAT(header([](Header& h) { h.section_count = 0xFFFFFFFF; }), HasSubstr("its size"));
  EXPECT_THAT(header([](Header& h) {
                h.header_bytes = kFixedBytes;
                h.section_count = 0;
              }),
              HasSubstr("its size is wrong"));
  EXPECT_THAT(header([](Header& h) {
                h.header_bytes = sizeof(Header);
                h.section_count = 0;
              }),
              HasSubstr("its size is wrong"));
  EXPECT_THAT(header([](Header& h) { ++h.file_bytes; }), HasSubstr(" bytes where "));
  EXPECT_THAT(header([](Header& h) { ++h.mesh_face_count; }),
              HasSubstr("'face_valence': 1 entries"));
  for (const double unit : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_THAT(header([&](Header& h) { h.unit = unit; }), HasSubstr("the unit"));
  }
  EXPECT_THAT(header([&](Header& h) { h.origin[1] = kNaN; }), HasSubstr("the origin"));
  for (const double scale : {0.0, -2.0, 3.0, kNaN, kInfinity}) {
    EXPECT_THAT(header([&](Header& h) { h.scale = scale; }), HasSubstr("the scale"));
  }

  const auto section = [](const std::string& name, auto change) {
    return Forgery(triangle_cache()).change_section(name, change).what();
  };
  EXPECT_THAT(section("domain", [](Section& s) { s.name[0] = 'D'; }),
              HasSubstr("'domain': its entry"));
  EXPECT_THAT(section("control", [](Section& s) { ++s.offset; }),
              HasSubstr("'control': its entry"));
  EXPECT_THAT(section("control", [](Section& s) { s.element = Element::kUint32; }),
              HasSubstr("'control': its entry"));
  for (const std::uint64_t count :
       {std::uint64_t{1} << 20, std::uint64_t{1} << 62, ~std::uint64_t{0}}) {
    EXPECT_THAT(section("control", [&](Section& s) { s.count = count; }),
                HasSubstr("'control': ends beyond the file"));
  }
  EXPECT_THAT(section("face_valence", [](Section& s) { s.count = 0; }),
              HasSubstr("more than its sections"));
}

// Sound checksums over what no build makes.
TEST(CacheFile, ForgedContentIsRefused) {
  const PatchCache dart = dart_cache(), torus_cache = paper_torus();
  const auto& surface = std::get<1>(torus_cache.surface);
  const auto forged = [&](const std::string& section, std::size_t index, auto value) {
    const CacheError error = Forgery(torus_cache).set(section, index, value).refusal();
    EXPECT_FALSE(error.stale);
    return std::string(error.what());
  };
  const auto section = [](const std::string& name) {
    return HasSubstr("section '" + name + "': ");
  };
  const std::uint32_t patches = torus_cache.patch_count(), sides = 4 * patches;

  EXPECT_THAT(forged("domain_begin", 4, ~0u), section("domain_begin"));
  EXPECT_THAT(forged("domain_begin", 4, 1u), section("domain_begin"));
  EXPECT_THAT(forged("side_begin", 0, 1u), section("side_begin"));
  EXPECT_THAT(forged("side_begin", 1, 2u), section("side_begin"));
  EXPECT_THAT(forged("side_begin", 1, ~0u), section("side_begin"));
  EXPECT_THAT(forged("side_begin", patches, sides - 1), section("side_begin"));
  EXPECT_THAT(forged("side_patch", 5, 0u), section("side_patch"));
  EXPECT_THAT(forged("side_twin", 3, sides), section("side_twin"));
  EXPECT_THAT(forged("side_twin", 3, 3u), section("side_twin"));
  EXPECT_THAT(forged("side_twin", 3, kNone), section("side_twin"));
  EXPECT_THAT(forged("control_begin", 2, 1u), section("control_begin"));
  EXPECT_THAT(forged("form", 0, kFormRibbon), section("form"));  // of an exact cache
  EXPECT_THAT(forged("form", 0, ~0u), section("form"));
  EXPECT_THAT(forged("form", 0, kFormPaper | 4u << 8), section("form"));
  EXPECT_THAT(forged("triangle", 7, 4u), section("triangle"));
  EXPECT_THAT(forged("patch_face", 2, patches), section("patch_face"));
  EXPECT_THAT(forged("patch_face", 2, 1u), section("side_begin"));  // parts are triangles
  EXPECT_THAT(forged("face_patch", 2, 1u), section("face_patch"));
  EXPECT_THAT(forged("face_patch", 2, kNone), section("face_patch"));
  EXPECT_THAT(forged("kind", 0, std::uint8_t{4}), section("kind"));
  EXPECT_THAT(forged("folded", 0, std::uint8_t{2}), section("folded"));
  EXPECT_THAT(forged("rho_min", 0, -1.0), section("rho_min"));
  EXPECT_THAT(forged("corner_of_face", 1, 2u), section("corner_of_face"));
  for (const std::uint32_t n : {2u, 5u, 1001u}) {
    EXPECT_THAT(forged("face_valence", 0, n),
                ::testing::AnyOf(section("face_valence"), section("side_begin")));
  }
  for (const double scale : {3.0, 0.0, -1.0}) {
    EXPECT_THAT(forged("patch", kPatchReals + kPatchScale, scale), section("patch"));
    EXPECT_THAT(forged("patch", kPatchReals + kPatchUnscale, scale), section("patch"));
  }
  EXPECT_THAT(forged("patch", kPatchSag, -1.0), section("patch"));
  EXPECT_THAT(forged("patch", kPatchCurvature, -1.0), section("patch"));
  EXPECT_THAT(forged("patch", kPatchNormal, 2.0), section("patch"));
  EXPECT_THAT(forged("patch", kPatchTangent + 1, 2.0), section("patch"));
  // A patch much larger than the mesh.
  EXPECT_THAT(Forgery(torus_cache)
                  .set("patch", kPatchScale, 0x1p-9)
                  .set("patch", kPatchUnscale, 0x1p9)
                  .refusal()
                  .what(),
              section("patch"));
  EXPECT_THAT(forged("tile_begin", 1, surface.tile_begin[1] - 1), section("tile_begin"));
  for (const std::string name : {"domain", "control", "corner", "patch", "node", "rho_min"}) {
    EXPECT_THAT(forged(name, 2, kNaN), section(name));
    EXPECT_THAT(forged(name, 2, kInfinity), section(name));
  }

  EXPECT_THAT(forged("child", 0, 0u), section("child"));                   // cyclic
  EXPECT_THAT(forged("child", 2, 0u), section("child"));                   // cyclic
  EXPECT_THAT(forged("child", 0, patches - 1), section("child"));          // out of range
  EXPECT_THAT(forged("child", 0, patches | kNodeLeaf), section("child"));  // out of range
  EXPECT_THAT(forged("child", 0, surface.child[1]), section("child"));     // twice
  const auto leaf = std::find_if(surface.child.begin(), surface.child.end(),
                                 [](std::uint32_t c) { return c & kNodeLeaf; });
  const auto at = static_cast<std::size_t>(leaf - surface.child.begin());
  EXPECT_THAT(forged("child", at, *leaf ^ 1u), section("child"));  // twice

  // The patches of a cut face.
  ASSERT_GT(dart.patch_count(), 1u);
  EXPECT_THAT(Forgery(dart).set("corner_of_face", 0, 6u).what(), section("corner_of_face"));
  EXPECT_THAT(Forgery(dart).set("corner_of_face", 0, dart.corner_of_face[1]).what(),
              section("corner_of_face"));

  // Parts that overlap.
  const Mesh one = goldberg(2, 10).mesh;
  const PatchCache balls = build_cache(test::joined({one, test::moved(one, Vec3(9, 1, 0))}));
  EXPECT_STREQ(Forgery(balls).refusal().what(), "was loaded");
  const auto forged_ball = [&](const std::string& name, std::size_t index, std::uint32_t value) {
    return std::string(Forgery(balls).set(name, index, value).refusal().what());
  };
  EXPECT_THAT(forged_ball("part", 0, 2), section("part"));
  EXPECT_THAT(forged_ball("partner", 0, 2), section("partner"));
  EXPECT_THAT(forged_ball("part_table", 1, 3), section("part_table"));
  EXPECT_THAT(forged_ball("part_table", 2, balls.patch_count()), section("part_table"));

  // Pieces of the polygon of a face that is cut round a centre.
  const PatchCache fan = fan_cache();
  const auto& triangle = std::get<1>(fan.surface).triangle;
  const auto piece =
      static_cast<std::size_t>(std::find_if(triangle.begin(), triangle.end(),
                                            [](std::uint32_t c) { return c >= kFanPiece; }) -
                               triangle.begin());
  ASSERT_LT(piece, triangle.size());
  EXPECT_STREQ(Forgery(fan).refusal().what(), "was loaded");
  EXPECT_THAT(forged("triangle", 0, kFanPiece), section("triangle"));
  EXPECT_THAT(Forgery(fan).set("triangle", piece, kFanPiece | 3u).what(), section("triangle"));
  EXPECT_THAT(Forgery(fan).set("triangle", piece, 0u).what(), section("triangle"));
  EXPECT_THAT(Forgery(fan).set("triangle", piece + 1, triangle[piece + 1] + 3).what(),
              section("triangle"));
  EXPECT_THAT(Forgery(fan).set("triangle", piece + 2, 4u).what(), section("triangle"));
  EXPECT_THAT(Forgery(fan).set("domain_begin", 0, 0u).what(), section("triangle"));
}

// A tree like a list, of n leaves: its deepest leaf is n levels down, the root being the first.
Forgery list_of(std::uint32_t n) {
  PatchCache cache = build_cache(torus(static_cast<int>(n) / 4, 4).mesh);
  auto& surface = std::get<1>(cache.surface);
  auto& child = surface.child;
  for (std::size_t i = 0; i < surface.node.size(); ++i) surface.node[i] = i % 6 < 3 ? -2 : 2;
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    child[2 * i] = i | kNodeLeaf;
    child[2 * i + 1] = i + 2 < n ? i + 1 : (n - 1) | kNodeLeaf;
  }
  return Forgery(cache);
}

TEST(CacheFile, HierarchiesDeeperThanTheWalkersStackAreRefused) {
  EXPECT_EQ(list_of(64).what(), "was loaded");
  EXPECT_THAT(list_of(68).what(), HasSubstr("section 'child': entry 126: "));
}

TEST(CacheFile, FullDiskLeavesTheOldFileAndNothingElse) {
  const ScratchFolder folder;
  const std::string path = folder / "scene.gliss";
  save_cache(triangle_cache(), path);
  const PatchCache big = build_cache(torus().mesh);
  struct Limit {
    rlimit old;
    void (*handler)(int) = std::signal(SIGXFSZ, SIG_IGN);
    Limit() {
      getrlimit(RLIMIT_FSIZE, &old);
      const rlimit low{100000, old.rlim_max};
      setrlimit(RLIMIT_FSIZE, &low);
    }
    ~Limit() {
      setrlimit(RLIMIT_FSIZE, &old);
      std::signal(SIGXFSZ, handler);
    }
  };
  {
    const Limit limit;
    for (const std::string name : {"scene.gliss", "new.gliss"}) {
      EXPECT_EQ(test::message_of<std::system_error>([&] { save_cache(big, folder / name); }),
                "cannot write '" + (folder / name) + "': File too large");
    }
  }
  EXPECT_EQ(folder.file_count(), 1u);
  EXPECT_TRUE(equal(load_cache(path), triangle_cache()));
  EXPECT_THROW(save_cache(big, "/dev/full"), std::system_error);
  EXPECT_THROW(save_cache(big, folder / "none/scene.gliss"), std::system_error);
}

TEST(CacheFile, ConcurrentWritersLeaveOneWholeFile) {
  const ScratchFolder folder;
  const std::string path = folder / "scene.gliss";
  const PatchCache caches[] = {build_cache(torus().mesh), triangle_cache()};
  save_cache(caches[0], path);
  std::atomic<int> writing{8};
  {
    std::vector<std::jthread> writers;
    for (std::size_t w = 0; w < 8; ++w) {
      writers.emplace_back([&, w] {
        for (std::size_t i = 0; i < 4; ++i) save_cache(caches[(w + i) % 2], path);
        --writing;
      });
    }
    do {
      const PatchCache seen = load_cache(path);
      EXPECT_TRUE(equal(seen, caches[seen.mesh_face_count == 1]));
    } while (writing > 0);
  }
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace
}  // namespace gliss
