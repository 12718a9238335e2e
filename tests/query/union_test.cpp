// Parts that overlap or touch are a union of solids: inside one is inside, the contact lies on the
// union's surface, and on a seam it rests against two or three parts at once.
#include "gliss/engine/engine.h"
#include "gliss/engine/opencl.h"
#include "gliss/query/contact_tracker.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/require.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

constexpr double kRadius = 10;

std::vector<Mesh> two_spheres(double overlap) {
  const Mesh sphere = goldberg(4, kRadius).mesh;
  return {sphere, test::moved(sphere, Vec3(2 * kRadius - overlap, 0, 0))};
}

// Three spheres that meet in corners.
std::vector<Mesh> three_spheres() {
  const Mesh sphere = goldberg(4, kRadius).mesh;
  return {sphere, test::moved(sphere, Vec3(15, 0.4, 0.3)), test::moved(sphere, Vec3(7.3, 13.2, 1))};
}

std::vector<Mesh> linked_tori() {
  Mesh other = torus().mesh;
  for (auto* vectors : {&other.positions, &other.normals}) {
    for (Vec3& v : *vectors) v = Vec3(v.x(), -v.z(), v.y());
  }
  return {torus().mesh, test::moved(other, Vec3(33, 4, 3))};
}

std::vector<Mesh> crossing_plates() {
  Mesh other = thin_plate(8, 8, 20, 4).mesh;
  for (auto* vectors : {&other.positions, &other.normals}) {
    for (Vec3& v : *vectors) v = Vec3(v.x(), -v.z(), v.y());
  }
  return {thin_plate(8, 8, 30, 6).mesh, test::moved(other, Vec3(1, 2, 5))};
}

struct Scene {
  const char* name;
  std::vector<Mesh> parts;
};
std::vector<Scene> scenes() {
  return {{"spheres 0.1", two_spheres(0.1)},  {"spheres 0.5", two_spheres(0.5)},
          {"spheres 1", two_spheres(1)},      {"spheres 5", two_spheres(5)},
          {"three spheres", three_spheres()}, {"tori", linked_tori()},
          {"plates", crossing_plates()}};
}

// Near the surface of the union, within `reach` of a random point of it.
std::vector<Vec3> hips_near(const PatchCache& cache, double reach, int count, unsigned seed) {
  Rng rng(seed);
  std::vector<Vec3> hips;
  while (static_cast<int>(hips.size()) < count) {
    const auto face = static_cast<std::uint32_t>(rng() % cache.mesh_face_count);
    const int n = static_cast<int>(cache.face_valence[face]);
    const Vec3 x = test::at(cache, face, oracle::random_inside<double>(rng, n)).position;
    hips.push_back(x + uniform(rng, 0, reach) * oracle::random_unit(rng));
  }
  return hips;
}

double size_of(const PatchCache& cache) {
  const Box box = cache.bounds();
  return (box.high - box.low).maxCoeff();
}

TEST(Union, of_parts_knows_what_is_inside) {
  for (const auto& [name, parts] : scenes()) {
    const PatchCache cache = test::cache_of(test::joined(parts));
    const test::UnionOracle truth(parts, 1);
    int wrong = 0, inside = 0, judged = 0;
    const int count = static_cast<int>(test::samples(600, 100'000));
    for (const Vec3& hip : hips_near(cache, 0.1 * size_of(cache), count, 1)) {
      if (truth.off_surface(hip) < 1e-6 * size_of(cache)) continue;
      const bool is_inside = truth.depth(hip) > 0;
      ++judged;
      inside += is_inside;
      wrong += nearest(cache, hip).touching != is_inside;
    }
    test::record(name, "{} of {} signs wrong, {} inside", wrong, judged, inside);
    EXPECT_EQ(wrong, 0) << name;
    EXPECT_GT(inside, count / 5) << name;
  }
}

TEST(Union, has_contacts_on_its_surface_that_are_nearest) {
  for (const auto& [name, parts] : scenes()) {
    const PatchCache cache = test::cache_of(test::joined(parts));
    const test::UnionOracle truth(parts, 5);
    const double size = size_of(cache);
    int touching = 0, seams = 0, far = 0, lost = 0;
    test::Worst off, deep, longer;
    for (const Vec3& hip :
         hips_near(cache, 0.15 * size, static_cast<int>(test::samples(100, 20'000)), 2)) {
      const Contact contact = nearest(cache, hip);
      if (!contact.touching) continue;
      ++touching;
      const bool seam = (contact.flags & kOnCrease) != 0;
      seams += seam;
      lost += (contact.flags & kConverged) == 0;
      off.add(truth.off_surface(contact.scp) / size);
      deep.add(std::max(0.0, truth.depth(contact.scp)) / size);
      const double more = contact.push.norm() - truth.to_samples(hip);
      longer.add(more / size);
      far += more > 1e-9 * size;
    }
    test::record(
        name,
        "{} touching, {} on seams, {} not converged; off the surface {:.1g}, beneath it {:.1g}; "
        "{} farther than a sample, by {:.1g}",
        touching, seams, lost, off.value, deep.value, far, longer.value);
    EXPECT_GT(touching, 0) << name;
    EXPECT_EQ(lost, 0) << name;
    EXPECT_LE(off.value, 1e-8) << name;
    EXPECT_LE(deep.value, 1e-8) << name;
    // Deep inside, the nearest of several seams may be missed.
    EXPECT_LE(far, touching / 50) << name;
    EXPECT_LE(longer.value, 0.01) << name;
  }
}

// 0.5 mm beneath the first sphere, through the seam, on beneath its buried side.
TEST(Union, holds_a_path_that_goes_on_beneath_a_buried_side) {
  for (const double overlap : {0.1, 0.5, 1.0, 5.0}) {
    const std::vector<Mesh> parts = two_spheres(overlap);
    const PatchCache cache = test::cache_of(test::joined(parts));
    const test::UnionOracle truth(parts, 0);
    ContactTracker tracker(cache, {});
    constexpr int kTicks = 4000;
    int free = 0, seams = 0;
    test::Worst off, deep;
    for (int i = 0; i <= kTicks; ++i) {
      const double angle = std::numbers::pi * (0.6 - 1.2 * i / kTicks);
      const double r = i < 200 ? 10.5 - i / 200.0 : 9.5;
      const Vec3 hip = r * Vec3(std::cos(angle), std::sin(angle), 0.03);
      const Contact contact = tracker.tick(hip);
      if (i < 250) continue;
      free += !contact.touching;
      seams += (contact.flags & kOnCrease) != 0;
      EXPECT_GE(contact.push.norm(), nearest(cache, hip).push.norm() - 1e-9);
      if (i % 10 != 0) continue;
      off.add(truth.off_surface(contact.scp));
      deep.add(std::max(0.0, truth.depth(contact.scp)));
    }
    test::record(fmt::format("overlap {}", overlap),
                 "{} free ticks, {} on the seam; SCP {:.1g} mm off the surface, {:.1g} beneath it",
                 free, seams, off.value, deep.value);
    EXPECT_EQ(free, 0) << overlap;
    EXPECT_TRUE(seams > 100 || overlap < 0.5) << overlap;
    EXPECT_LE(off.value, 1e-7) << overlap;
    EXPECT_LE(deep.value, 1e-7) << overlap;
  }
}

// Beneath the one sphere, then beneath the other: where both push, the push turns no faster than
// the seam does, seen from the HIP.
TEST(Union, crosses_a_smooth_seam_without_a_step) {
  for (const double overlap : {0.5, 1.0, 5.0}) {
    const std::vector<Mesh> parts = two_spheres(overlap);
    const PatchCache cache = test::cache_of(test::joined(parts));
    const double depth = overlap < 1 ? 0.1 : 0.3, middle = kRadius - overlap / 2;
    double largest = 0;
    int free = 0, seams = 0;
    constexpr int kPaths = 8, kTicks = 2000;
    for (int path = 0; path < kPaths; ++path) {
      ContactTracker tracker(cache, {});
      const double turn = 0.1 + 2 * std::numbers::pi * path / kPaths,
                   last_angle = std::acos(middle / (kRadius - depth));
      Contact last;
      Vec3 before = Vec3::Zero();
      for (int i = 0; i <= kTicks; ++i) {
        const double way = 2.0 * i / kTicks - 1, angle = last_angle + 1.2 * std::abs(way),
                     x = (kRadius - depth) * std::cos(angle),
                     y = (kRadius - depth) * std::sin(angle);
        const Vec3 hip(way < 0 ? x : 2 * middle - x, y * std::cos(turn), y * std::sin(turn));
        const Contact contact = tracker.tick(hip);
        free += !contact.touching;
        seams += (contact.flags & kOnCrease) != 0;
        if (i > 0)
          largest = std::max(largest, (contact.push - last.push).norm() / (hip - before).norm());
        last = contact;
        before = hip;
      }
    }
    test::record(fmt::format("overlap {}", overlap),
                 "{} free ticks, {} on the seam, largest step {:.3f} k |dx|", free, seams, largest);
    EXPECT_EQ(free, 0) << overlap;
    EXPECT_GT(seams, 10 * kPaths) << overlap;
    EXPECT_LE(largest, 2) << overlap;
  }
}

// A hand that wanders at the surface: the tick knows inside from outside as the oracle does, and
// where it touches it rests on the union's surface.
TEST(Union, of_three_spheres_holds_a_hand_that_wanders_over_seams_and_corners) {
  const std::vector<Mesh> parts = three_spheres();
  const PatchCache cache = test::cache_of(test::joined(parts));
  const test::UnionOracle truth(parts, 0);
  Rng rng(7);
  int wrong = 0, seams = 0, touching = 0, other = 0;
  test::Worst off, deep;
  const int ticks = static_cast<int>(test::samples(5000, 500'000));
  ContactTracker tracker(cache, {});
  Vec3 hip(7.3, 4.4, 7), aim = hip;
  for (int i = 0; i < ticks; ++i) {
    if (i % 40 == 0) {
      // On near the corner where all three meet, from 0.3 mm above the surface to 0.3 mm beneath.
      const Vec3 x = 0.5 * (hip + Vec3(7.4, 4.7, 5.2)) + 2 * oracle::random_unit(rng);
      const Contact there = nearest(cache, x);
      const Vec3 way = (there.scp - x).normalized();
      aim = there.scp + uniform(rng, -0.3, 0.3) * (there.touching ? way : Vec3(-way));
    }
    hip += 0.1 * (aim - hip);
    const Contact contact = tracker.tick(hip);
    touching += contact.touching;
    seams += contact.touching && (contact.flags & kOnCrease) != 0;
    if (truth.off_surface(hip) < 1e-6) continue;
    wrong += contact.touching != (truth.depth(hip) > 0);
    if (!contact.touching) continue;
    other += std::abs(contact.push.norm() - nearest(cache, hip).push.norm()) > 1e-9;
    off.add(truth.off_surface(contact.scp));
    deep.add(std::max(0.0, truth.depth(contact.scp)));
  }
  test::record("wandering",
               "{} of {} ticks touch, {} on seams; {} wrong, {} not the nearest; SCP {:.1g} mm off "
               "the surface, {:.1g} beneath it",
               touching, ticks, seams, wrong, other, off.value, deep.value);
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(seams, ticks / 20);
  EXPECT_LE(other, touching / 50);
  EXPECT_LE(off.value, 1e-7);
  EXPECT_LE(deep.value, 1e-7);
}

// Two boxes with a face in common: nothing is left of it.
TEST(Union, of_boxes_that_touch_has_no_surface_between_them) {
  const Mesh box = thin_plate(4, 4, 10, 10).mesh;
  const PatchCache cache = test::cache_of(test::joined({box, test::moved(box, Vec3(10, 0, 0))}));
  Rng rng(4);
  double least = 100;
  for (int i = 0; i < 500; ++i) {
    const Vec3 hip(5 + uniform(rng, -1, 1), uniform(rng, -2, 2), uniform(rng, -2, 2));
    const Contact contact = nearest(cache, hip);
    ASSERT_TRUE(contact.touching);
    least = std::min(least, contact.push.norm());
  }
  test::record("boxes", "the way out is at least {:.3f} mm", least);
  EXPECT_GT(least, 2.5);
  for (const double depth : {0.05, 0.3, 1.0}) {
    for (const double way : {1.0, -1.0}) {
      ContactTracker tracker(cache, {});
      const double top = nearest(cache, Vec3(0, 0.3, 9)).scp.z();
      int free = 0;
      double lowest = 100;
      for (int i = -20; i <= 400; ++i) {
        const double height = i < 0 ? -0.1 * i : 0;
        const Contact contact = tracker.tick(
            Vec3(5 - way * 4 + way * std::max(0, i) * 0.02, 0.3, top + height - depth));
        if (i < 0) continue;
        free += !contact.touching;
        lowest = std::min(lowest, contact.scp.z());
      }
      EXPECT_EQ(free, 0) << depth;
      EXPECT_GT(lowest, top - 1.2) << depth;
    }
  }
}

TEST(Union, costs_nothing_where_parts_do_not_meet) {
  const auto part_arrays = [](const PatchCache& cache) {
    const auto& s = std::get<Surface<double>>(cache.surface);
    return s.part.size() + s.part_table.size() + s.partner.size() + s.part_box.size();
  };
  EXPECT_EQ(part_arrays(test::cache_of(torus_knot().mesh)), 0u);
  EXPECT_EQ(part_arrays(test::cache_of(test::joined(two_spheres(-0.2)))), 0u);
  EXPECT_GT(part_arrays(test::cache_of(test::joined(two_spheres(0.2)))), 0u);
  const Mesh sphere = goldberg(4, 10).mesh;
  EXPECT_GT(part_arrays(test::cache_of(test::joined({sphere, goldberg(2, 3).mesh}))), 0u);
  EXPECT_EQ(part_arrays(test::cache_of(
                test::joined({sphere, test::moved(goldberg(2, 3).mesh, Vec3(12, 12, 0))}))),
            0u);
}

TEST(Union, gives_the_same_bytes_on_opencl) {
  const auto serial = make_serial_engine();
  OpenClOptions on_device;
  on_device.smallest_batch = 0;
  std::unique_ptr<Engine> opencl;
  try {
    opencl = make_opencl_engine(on_device);
  } catch (const DeviceError& e) {
    GLISS_SKIP_UNLESS_REQUIRED(e.what());
  }
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    const PatchCache cache = test::cache_of(test::joined(three_spheres()), precision);
    const std::vector<Vec3> hips = hips_near(cache, 3, 600, 3);
    std::vector<Contact> want(hips.size()), got(hips.size());
    serial->reside(cache)->project(hips, {}, want);
    opencl->reside(cache)->project(hips, {}, got);
    EXPECT_GT(opencl->device_seconds(), 0);
    int different = 0;
    for (std::size_t i = 0; i < hips.size(); ++i)
      different += want[i].scp != got[i].scp || want[i].push != got[i].push ||
                   want[i].touching != got[i].touching || want[i].iterations != got[i].iterations;
    EXPECT_EQ(different, 0);
  }
}

class UnionOfShared : public test::SharedTest {};

// 32 teeth that stand within each other here and there.
TEST_F(UnionOfShared, teeth_knows_what_is_inside) {
  const Mesh mesh = test::load_shared("meshes/teeth32_ngon");
  const PatchCache cache = test::cache_of(mesh);
  const std::vector<Mesh> parts = test::parts_of(mesh);
  ASSERT_EQ(parts.size(), 32u);
  const test::UnionOracle truth(parts, 0);
  const test::Winding winding(parts, 8);
  const double size = size_of(cache);
  int wrong = 0, inside = 0, judged = 0, wound = 0, odd = 0;
  const int count = static_cast<int>(test::samples(2000, 100'000));
  for (const Vec3& hip : hips_near(cache, 0.02 * size, count, 5)) {
    const double distance = truth.off_surface(hip);
    if (distance < 1e-6 * size) continue;
    const bool is_inside = truth.depth(hip) > 0, touches = nearest(cache, hip).touching;
    ++judged;
    inside += is_inside;
    wrong += touches != is_inside;
    // Farther than the triangles are from the surface.
    if (distance < 5e-4 * size) continue;
    ++wound;
    odd += touches != (winding.at(hip) > 0.5);
  }
  test::record("teeth", "{} of {} signs wrong, {} inside; {} of {} against winding numbers", wrong,
               judged, inside, odd, wound);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(odd, 0);
  EXPECT_TRUE(nearest(cache, Vec3(-17.2467, 626.879, 116.0972)).touching);
}

// Between the walls of two teeth that stand within each other the surface of the union is so far
// that a tick's evaluations do not find it. A contact that followed each tick's best guess went to
// and fro between the walls, while the hand moved slowly on.
TEST_F(UnionOfShared, teeth_hold_a_contact_that_a_tick_cannot_find) {
  const Vec3 way[] = {{16.29215, 625.96102, 110.13916}, {16.33820, 627.35102, 110.35284},
                      {16.33822, 627.34972, 110.38032}, {16.34177, 627.34234, 110.40603},
                      {16.33950, 627.33722, 110.43206}, {16.32563, 627.33769, 110.45479},
                      {16.30152, 627.34245, 110.46596}, {16.27532, 627.34830, 110.47101}};
  const Mesh mesh = test::load_shared("meshes/teeth32_ngon");
  for (const Construction construction : {Construction::kPaper, Construction::kFair}) {
    const PatchCache cache = test::cache_of(mesh, Precision::kDouble, true, nullptr, construction);
    ContactTracker tracker(cache, {});
    int jumps = 0, free = 0;
    Vec3 last = Vec3::Zero();
    for (std::size_t leg = 0; leg + 1 < std::size(way); ++leg) {
      const int ticks = leg == 0 ? 20 : 40;
      for (int i = 0; i < ticks; ++i) {
        const double t = i / static_cast<double>(ticks);
        const Contact contact = tracker.tick((1 - t) * way[leg] + t * way[leg + 1]);
        if (leg > 0) {
          jumps += (contact.push - last).norm() > 0.2 * last.norm();
          free += !contact.touching;
        }
        last = contact.push;
      }
    }
    test::record(construction == Construction::kPaper ? "paper" : "fair", "{} jumps, {} free ticks",
                 jumps, free);
    EXPECT_LE(jumps, 1);
    EXPECT_EQ(free, 0);
  }
}

}  // namespace
}  // namespace gliss
