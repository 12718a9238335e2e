// Parts that overlap or touch are a union of solids: inside one is inside, the contact lies on the
// union's surface, and on a seam it rests against two or three parts at once.
#include <array>

#include "gliss/engine/engine.h"
#include "gliss/engine/opencl.h"
#include "gliss/query/contact_tracker.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/bytes.h"
#include "tests/support/require.h"
#include "tests/support/sharp_meshes.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

constexpr double kRadius = 10;

// A part as it is meant, and the signed distance to it by formula, if there is one.
struct Part {
  Mesh mesh;
  std::function<double(const Vec3&)> formula = nullptr;
};

Part moved(const Part& part, const Vec3& by) {
  const auto formula = [of = part.formula, by](const Vec3& x) { return of(x - by); };
  return {test::moved(part.mesh, by), part.formula ? formula : part.formula};
}

Part part_of(const Generated& made) {
  return {made.mesh, [exact = made.exact](const Vec3& x) { return exact->nearest(x).distance; }};
}

// y for z, and z for -y.
Part laid_down(Part part) {
  for (auto* vectors : {&part.mesh.positions, &part.mesh.normals}) {
    for (Vec3& v : *vectors) v = Vec3(v.x(), -v.z(), v.y());
  }
  if (part.formula) {
    part.formula = [of = part.formula](const Vec3& x) { return of({x.x(), x.z(), -x.y()}); };
  }
  return part;
}

struct Scene {
  const char* name;
  std::vector<Part> parts;

  std::vector<Mesh> meshes() const {
    std::vector<Mesh> all;
    for (const Part& part : parts) all.push_back(part.mesh);
    return all;
  }
  PatchCache cache() const { return test::cache_of(test::joined(meshes())); }
  // To the union of what the parts are meant to be.
  double formula(const Vec3& x) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Part& part : parts) least = std::min(least, part.formula(x));
    return least;
  }
};

Part sphere(int frequency = 4) { return part_of(goldberg(frequency, kRadius)); }

Scene two_spheres_of(const char* name, double overlap) {
  return {name, {sphere(), moved(sphere(), Vec3(2 * kRadius - overlap, 0, 0))}};
}
std::vector<Mesh> two_spheres(double overlap) { return two_spheres_of("", overlap).meshes(); }

// Three spheres that meet in corners.
Scene three_spheres_of(int frequency = 4) {
  const Part one = sphere(frequency);
  return {"three spheres", {one, moved(one, Vec3(15, 0.4, 0.3)), moved(one, Vec3(7.3, 13.2, 1))}};
}
std::vector<Mesh> three_spheres() { return three_spheres_of().meshes(); }

Scene linked_tori() {
  return {"tori", {part_of(torus()), moved(laid_down(part_of(torus())), Vec3(33, 4, 3))}};
}

Scene crossing_plates() {
  return {"plates",
          {{thin_plate(8, 8, 30, 6).mesh},
           moved(laid_down({thin_plate(8, 8, 20, 4).mesh}), Vec3(1, 2, 5))}};
}

std::vector<Scene> scenes() {
  return {two_spheres_of("spheres 0.1", 0.1),
          two_spheres_of("spheres 0.5", 0.5),
          two_spheres_of("spheres 1", 1),
          two_spheres_of("spheres 5", 5),
          three_spheres_of(),
          linked_tori(),
          crossing_plates()};
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

// The distance of the patches from what the parts are meant to be, at most, by samples.
double off_formula(const Scene& scene) {
  double most = 0;
  for (const Part& part : scene.parts) {
    const PatchCache cache = test::cache_of(test::with_normals(part.mesh));
    for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
      const int n = static_cast<int>(cache.face_valence[face]);
      for (const test::Vec2& X : oracle::sample_domain<double>(n, 4))
        most = std::max(most, std::abs(part.formula(test::at(cache, face, X).position)));
    }
  }
  return most;
}

TEST(Union, of_parts_knows_what_is_inside) {
  for (const Scene& scene : scenes()) {
    const PatchCache cache = scene.cache();
    const test::UnionOracle truth(scene.meshes(), 1);
    int wrong = 0, inside = 0, judged = 0;
    const int count = static_cast<int>(test::samples(600, 100'000));
    const std::vector<Vec3> hips = hips_near(cache, 0.1 * size_of(cache), count, 1);
    for (const Vec3& hip : hips) {
      if (truth.off_surface(hip) < 1e-6 * size_of(cache)) continue;
      const bool is_inside = truth.depth(hip) > 0;
      ++judged;
      inside += is_inside;
      wrong += nearest(cache, hip).touching != is_inside;
    }
    test::record(scene.name, "{} of {} signs wrong, {} inside", wrong, judged, inside);
    EXPECT_EQ(wrong, 0) << scene.name;
    EXPECT_GT(inside, count / 5) << scene.name;
    if (!scene.parts.front().formula) continue;
    // Patches are not spheres: by formula where a HIP is farther from those than patches are.
    const double off = 1.2 * off_formula(scene);
    int beyond = 0, other = 0;
    for (const Vec3& hip : hips) {
      const double distance = scene.formula(hip);
      if (std::abs(distance) < off) continue;
      ++beyond;
      other += nearest(cache, hip).touching != (distance < 0);
    }
    test::record(scene.name, "{} of {} signs wrong by formula, of HIPs beyond {:.2g} mm", other,
                 beyond, off);
    EXPECT_EQ(other, 0) << scene.name;
    EXPECT_GT(beyond, 0.9 * count) << scene.name;
  }
}

// Patches of boxes with creases are flat, so that formulas are exact.
TEST(Union, of_boxes_is_exact_by_formula) {
  struct {
    const char* name;
    std::vector<Box> boxes;
    // Deep inside, the nearest of several seams may be missed: at most by so much of the size, at
    // one of 150 HIPs.
    double missed = 0;
  } const all[] = {
      {"two", {{{0, 0, 0}, {4, 4, 4}}, {{3, 1, 2}, {9, 3, 7}}}},
      {"that touch", {{{0, 0, 0}, {4, 4, 4}}, {{4, 0, 0}, {8, 4, 4}}}},
      {"three that meet in a corner",
       {{{0, 0, 0}, {9, 2, 2}}, {{0, 0, 0.5}, {2, 9, 2.5}}, {{0.5, 0.5, 0}, {2.5, 2.5, 9}}},
       0.025},
      {"one within another", {{{0, 0, 0}, {9, 9, 9}}, {{3, 3, 3}, {5, 5, 5}}}}};
  for (const auto& [name, boxes, missed] : all) {
    std::vector<Mesh> parts;
    for (const Box& box : boxes) {
      parts.push_back(test::cube());
      for (Vec3& p : parts.back().positions) p = box.low + p.cwiseProduct(box.high - box.low);
    }
    const PatchCache cache = test::cache_of(test::with_creases(test::joined(parts)));
    const test::BoxUnion truth(boxes);
    const double size = size_of(cache);
    const int count = static_cast<int>(test::samples(2000, 100'000));
    int wrong = 0, inside = 0, judged = 0, far = 0, lost = 0;
    test::Worst outside, off, longer;
    for (const Vec3& hip : hips_near(cache, 0.3 * size, count, 6)) {
      const double distance = truth.distance(hip);
      if (std::abs(distance) < 1e-12 * size) continue;
      const Contact contact = nearest(cache, hip);
      ++judged;
      inside += distance < 0;
      wrong += contact.touching != (distance < 0);
      lost += (contact.flags & kConverged) == 0;
      off.add(std::abs(truth.distance(contact.scp)) / size);
      const double more = std::abs(contact.distance) - std::abs(distance);
      if (distance > 0) outside.add(std::abs(more) / size);
      if (distance > 0) continue;
      far += std::abs(more) > 1e-12 * size;
      longer.add(std::abs(more) / size);
    }
    test::record(fmt::format("boxes {}", name),
                 "{} of {} signs wrong, {} inside, {} not converged; SCP off the surface {:.1g}; "
                 "distance outside off by {:.1g}, inside by more than 1e-12 at {}, at most {:.1g}",
                 wrong, judged, inside, lost, off.value, outside.value, far, longer.value);
    EXPECT_EQ(wrong, 0) << name;
    EXPECT_EQ(lost, 0) << name;
    EXPECT_GT(inside, count / 5) << name;
    EXPECT_LE(off.value, 1e-12) << name;
    EXPECT_LE(outside.value, 1e-12) << name;
    EXPECT_LE(longer.value, std::max(missed, 1e-12)) << name;
    EXPECT_LE(far, missed > 0 ? inside / 150 : 0) << name;
  }
}

// Two bars that cross: in the corner between them the contact is on both.
TEST(Union, names_the_part_that_a_seam_presses_most) {
  std::vector<Mesh> bars{test::cube(), test::cube()};
  for (Vec3& p : bars[0].positions) p = Vec3(-9, -2, 0) + p.cwiseProduct(Vec3(18, 4, 9));
  for (Vec3& p : bars[1].positions) p = Vec3(-2, -9, 0) + p.cwiseProduct(Vec3(4, 18, 9));
  const PatchCache cache = test::cache_of(test::with_creases(test::joined(bars)));
  for (const Vec3& push : {Vec3(0.5, 1, 0), Vec3(1, 0.5, 0)}) {
    const Contact contact = nearest(cache, Vec3(2, 2, 4.5) - push);
    ASSERT_TRUE(contact.flags & kOnCrease);
    ASSERT_LT((contact.push - push).norm(), 1e-9);
    EXPECT_EQ(contact.at.face<bars[0].face_count(), push.y()> push.x());
  }
}

// A long box across the x-y plane, turned in it.
struct Beam {
  test::Vec2 middle, half;
  double angle;

  test::Vec2 to_own(const test::Vec2& p) const { return Eigen::Rotation2Dd(-angle) * (p - middle); }
  test::Vec2 from_own(const test::Vec2& p) const { return middle + Eigen::Rotation2Dd(angle) * p; }
  std::array<test::Vec2, 4> corners() const {
    const double x = half.x(), y = half.y();
    return {from_own({-x, -y}), from_own({x, -y}), from_own({x, y}), from_own({-x, y})};
  }
  bool holds(const test::Vec2& p) const { return (to_own(p).array().abs() < half.array()).all(); }
  // The share [from, to] of the way from a to b within it; empty where from >= to.
  std::array<double, 2> within(const test::Vec2& a, const test::Vec2& b) const {
    const test::Vec2 at = to_own(a), way = to_own(b) - at;
    double from = 0, to = 1;
    for (int axis = 0; axis < 2; ++axis) {
      const auto [low, high] =
          std::minmax({(-half[axis] - at[axis]) / way[axis], (half[axis] - at[axis]) / way[axis]});
      from = std::max(from, low);
      to = std::min(to, high);
    }
    return {from, to};
  }
  Mesh mesh(double half_length) const {
    Mesh box = test::cube();
    for (Vec3& p : box.positions) {
      const Vec3 own = 2 * p - Vec3::Ones();
      p << from_own(half.cwiseProduct(own.head<2>())), half_length * own.z();
    }
    return box;
  }
};

// From a point to the sides of the beams that are in no other beam.
double to_outline(const std::vector<Beam>& beams, const test::Vec2& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Beam& beam : beams) {
    const auto corners = beam.corners();
    for (std::size_t k = 0; k < 4; ++k) {
      const test::Vec2 a = corners[k], b = corners[(k + 1) % 4];
      std::vector<std::array<double, 2>> hidden;
      for (const Beam& other : beams) {
        if (&other != &beam) hidden.push_back(other.within(a, b));
      }
      std::sort(hidden.begin(), hidden.end());
      const double foot = (p - a).dot(b - a) / (b - a).squaredNorm();
      double seen = 0;
      const auto add = [&](double from, double to) {
        if (from < to)
          least = std::min(least, (a + std::clamp(foot, from, to) * (b - a) - p).norm());
      };
      for (const auto& [from, to] : hidden) {
        if (from >= to) continue;
        add(seen, from);
        seen = std::max(seen, to);
      }
      add(seen, 1);
    }
  }
  return least;
}

// Their planes meet at angles that are neither right nor flat, so that a seam may bound the union
// without being nearest.
TEST(Union, of_beams_at_angles_is_exact_by_formula) {
  const std::vector<Beam> beams = {
      {{0, 0}, {4, 2}, 0.1}, {{1.5, 0.5}, {4, 2}, 0.7}, {{0.5, 1}, {4, 2}, 1.3}};
  std::vector<Mesh> parts;
  for (const Beam& beam : beams) parts.push_back(beam.mesh(50));
  const PatchCache cache = test::cache_of(test::with_creases(test::joined(parts)));
  Rng rng(5);
  const int count = static_cast<int>(test::samples(3000, 100'000));
  int inside = 0, wrong = 0, far = 0;
  for (int i = 0; i < count; ++i) {
    const test::Vec2 p{uniform(rng, -5, 5), uniform(rng, -5, 5)};
    const bool held =
        std::any_of(beams.begin(), beams.end(), [&](const Beam& beam) { return beam.holds(p); });
    const Contact contact = nearest(cache, Vec3(p[0], p[1], uniform(rng, -1, 1)));
    const double more = std::abs(contact.distance) - to_outline(beams, p);
    inside += held;
    wrong += contact.touching != held;
    far += std::abs(more) > 1e-9;
  }
  test::record("beams", "{} of {} inside, {} signs wrong, {} distances", inside, count, wrong, far);
  EXPECT_GT(inside, count / 5);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(far, 0);
}

TEST(Union, has_contacts_on_its_surface_that_are_nearest) {
  for (const Scene& scene : scenes()) {
    const char* name = scene.name;
    const PatchCache cache = scene.cache();
    const test::UnionOracle truth(scene.meshes(), 5);
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

// HIPs beneath each point of the parts, buried ones too.
TEST(Union, is_what_a_sweep_feels) {
  const std::vector<Mesh> parts = three_spheres();
  const PatchCache cache = test::cache_of(test::joined(parts));
  const test::UnionOracle truth(parts, 0);
  SweepOptions options;
  options.depths = {0.5e-3};
  options.methods = {Method::kGregory};
  options.rings = 1;
  int samples = 0, free = 0, buried = 0;
  test::Worst off, deep;
  sweep(cache, *make_serial_engine(), options, [&](const SweepBlock& block) {
    for (std::size_t i = 0; i < block.hip.size(); ++i) {
      ++samples;
      free += block.force[i].isZero(0);
      const Vec3 push = block.scp[i] - block.hip[i];
      EXPECT_LE((options.stiffness * cache.unit * push - block.force[i]).norm(), 1e-12);
      buried += push.norm() > 0.51;
      if (push.norm() < 0.51 && i % 16 != 0) continue;
      off.add(truth.off_surface(block.scp[i]));
      deep.add(std::max(0.0, truth.depth(block.scp[i])));
    }
  });
  test::record("sweep",
               "{} samples, {} free, {} buried; SCP {:.1g} mm off the surface, {:.1g} beneath it",
               samples, free, buried, off.value, deep.value);
  EXPECT_EQ(free, 0);
  EXPECT_GT(buried, samples / 50);
  EXPECT_LE(off.value, 1e-7);
  EXPECT_LE(deep.value, 1e-7);
}

// 0.5 mm beneath the first sphere, through the seam, on beneath its buried side.
TEST(Union, holds_a_path_that_goes_on_beneath_a_buried_side) {
  for (const double overlap : {0.1, 0.5, 1.0, 5.0}) {
    const std::vector<Mesh> parts = two_spheres(overlap);
    const PatchCache cache = test::cache_of(test::joined(parts));
    const test::UnionOracle truth(parts, 0);
    ContactTracker tracker(cache, test::leaping());
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

// Files have a part twice now and then: of two surfaces in one place neither buries the other.
TEST(Union, of_a_part_and_its_copy_is_the_part) {
  for (const Mesh& mesh : {sphere().mesh, test::cube()}) {
    const auto cache_of = [](const Mesh& of) { return test::cache_of(test::with_creases(of)); };
    const PatchCache one = cache_of(mesh), two = cache_of(test::joined({mesh, mesh}));
    for (const Vec3& hip : hips_near(one, 0.2 * size_of(one), 300, 8)) {
      const Contact want = nearest(one, hip), got = nearest(two, hip);
      EXPECT_EQ(got.touching, want.touching);
      EXPECT_NEAR(got.distance, want.distance, 1e-12 * kRadius);
      EXPECT_NEAR((got.push - want.push).norm(), 0, 1e-7 * kRadius);
      EXPECT_TRUE(got.flags & kConverged);
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

TEST(Union, gives_the_same_bytes_by_batch_and_on_opencl) {
  const auto serial = make_serial_engine(), tbb = make_tbb_engine(2);
  OpenClOptions on_device;
  on_device.smallest_batch = 0;
  std::unique_ptr<Engine> opencl;
  try {
    opencl = make_opencl_engine(on_device);
  } catch (const DeviceError& e) {
    GLISS_SKIP_UNLESS_REQUIRED(e.what());
  }
  constexpr std::array kMethods{Method::kGregory, Method::kShaded, Method::kFlat};
  for (const Precision precision : {Precision::kFloat, Precision::kDouble}) {
    const PatchCache cache = test::cache_of(test::joined(three_spheres_of(2).meshes()), precision);
    const std::vector<Vec3> hips = hips_near(cache, 3, 200, 3);
    std::vector<DomainPoint> starts(hips.size());
    for (std::size_t i = 0; i < starts.size(); ++i)
      starts[i].face = static_cast<std::uint32_t>(i % cache.mesh_face_count);
    SweepOptions options;
    options.depths = {0.5e-3};
    options.methods = {Method::kGregory};
    options.rings = 1;
    const auto asked = [&](const Engine& engine) {
      const auto surface = engine.reside(cache);
      std::vector<Contact> all(2 * kMethods.size() * hips.size());
      const std::span<Contact> nearest = std::span(all).first(all.size() / 2);
      surface->nearest(hips, kMethods, {}, nearest);
      for (std::size_t m = 0; m < kMethods.size(); ++m) {
        surface->track(hips, starts, {{}, kMethods[m]},
                       std::span(all).subspan(nearest.size() + m * hips.size(), hips.size()));
      }
      return std::pair(all, test::swept(cache, engine, options));
    };
    const auto [want, swept] = asked(*serial);
    for (std::size_t i = 0; i < hips.size(); ++i) {
      const Contact alone = nearest(cache, hips[i]);
      EXPECT_TRUE(alone.scp == want[i].scp && alone.push == want[i].push);
    }
    for (const Engine* engine : {tbb.get(), opencl.get()}) {
      const auto [got, swept_there] = asked(*engine);
      int different = 0;
      for (std::size_t i = 0; i < want.size(); ++i)
        different += want[i].scp != got[i].scp || want[i].push != got[i].push ||
                     want[i].touching != got[i].touching || want[i].iterations != got[i].iterations;
      EXPECT_EQ(different, 0) << engine->name();
      EXPECT_TRUE(swept_there == swept) << engine->name();
    }
    EXPECT_GT(opencl->device_seconds(), 0);
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
  const double size = size_of(cache);
  const test::Winding winding(parts, 1e-6 * size);
  int wrong = 0, inside = 0, judged = 0, odd = 0;
  const int count = static_cast<int>(test::samples(2000, 100'000));
  for (const Vec3& hip : hips_near(cache, 0.02 * size, count, 5)) {
    if (truth.off_surface(hip) < 1e-6 * size) continue;
    const bool is_inside = truth.depth(hip) > 0, touches = nearest(cache, hip).touching;
    ++judged;
    inside += is_inside;
    wrong += touches != is_inside;
    odd += touches != (winding.at(hip) > 0.5);
  }
  test::record("teeth", "{} of {} signs wrong, {} inside; {} against winding numbers", wrong,
               judged, inside, odd);
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
