// Hands that press in, slide and leave: what they are, what counts as held, and that nothing is.
#include "gliss/walk/leaving_walk.h"

#include "gliss/build/build_cache.h"
#include "gliss/build/complete_mesh.h"
#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "gliss/walk/walk.h"
#include "tests/extremes/extremes.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using Hands = std::vector<std::vector<Vec3>>;

Hands hands_on(const Mesh& mesh, std::size_t count, const ParallelFor& parallel = serial_for) {
  return leaving_paths(mesh, build_topology(mesh), {.hands = count, .rest = 300, .seed = 3},
                       parallel);
}

// The HIPs from one place to another, without the first.
std::vector<Vec3> line(const Vec3& from, const Vec3& to, int ticks) {
  std::vector<Vec3> path;
  for (int i = 1; i <= ticks; ++i) path.push_back(from + i / double(ticks) * (to - from));
  return path;
}

TEST(LeavingWalk, is_the_same_on_any_number_of_threads_and_with_more_hands) {
  const Mesh mesh = test::with_normals(banana().mesh);
  const auto engine = make_tbb_engine(3);
  const ParallelFor parallel = [&](std::size_t count, std::size_t grain, const auto& body) {
    engine->for_each(count, grain, body);
  };
  const Hands few = hands_on(mesh, 10), many = hands_on(mesh, 30, parallel);
  ASSERT_EQ(many.size(), 30u);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[i]);
  EXPECT_NE(leaving_paths(mesh, build_topology(mesh), {.hands = 1, .seed = 4})[0], few[0]);
  const PatchCache cache = test::cache_of(mesh);
  const HeldContacts serial = feel_leaving(cache, {}, many),
                     shared = feel_leaving(cache, {}, many, parallel);
  EXPECT_EQ(serial.contacts, shared.contacts);
  EXPECT_EQ(serial.held, shared.held);
  EXPECT_EQ(serial.longest, shared.longest);
  EXPECT_GE(serial.contacts, many.size());
}

TEST(LeavingWalk, goes_in_to_any_depth_at_any_speed_and_rests_outside) {
  const Mesh mesh = test::with_normals(torus_knot().mesh);
  const PatchCache base = build_base(mesh, build_topology(mesh), Precision::kDouble);
  const double size = test::size_of(mesh);
  const QueryOptions flat{{}, Method::kFlat};
  double slowest = 1, quickest = 0, shallowest = 1, deepest = 0;
  for (const std::vector<Vec3>& hips : hands_on(mesh, 300)) {
    double deep = 0;
    for (std::size_t i = 1; i + 300 < hips.size(); ++i) {
      const double step = (hips[i] - hips[i - 1]).norm() / size;
      slowest = std::min(slowest, step);
      quickest = std::max(quickest, step);
      if (i % 8 == 0) deep = std::max(deep, -nearest(base, hips[i], flat).distance / size);
    }
    if (deep > 0) shallowest = std::min(shallowest, deep);
    deepest = std::max(deepest, deep);
    EXPECT_GT(nearest(base, hips.back(), flat).distance, 0);
    EXPECT_EQ(hips.back(), hips[hips.size() - 301]);
  }
  EXPECT_LT(slowest, 1e-4);
  EXPECT_GT(quickest, 1e-2);
  EXPECT_LT(quickest, 2.1e-2);
  EXPECT_LT(shallowest, 0.001);
  EXPECT_GT(deepest, 0.04);  // the tube is 0.05 thick
}

// A ball of radius 10, and a contact on top of it.
class HeldBall : public ::testing::Test {
 protected:
  Contact contact_at_top(const Vec3& hip, std::uint32_t flags) const {
    Contact contact = nearest(cache_, {0, 0, 12});
    contact.touching = true;
    contact.push = contact.scp - hip;
    contact.flags = flags;
    return contact;
  }
  HeldContacts count_of(const QueryOptions& options, const std::vector<Vec3>& hips,
                        std::uint32_t flags) const {
    HeldOutsideCounter counter(cache_, options);
    for (const Vec3& hip : hips)
      counter.add(hip, contact_at_top(hip, flags), contact_at_top(hip, flags));
    const Contact free = nearest(cache_, {0, 0, 12});
    counter.add({0, 0, 12}, free, free);
    return counter.count();
  }

  const PatchCache cache_ = test::cache_of(test::with_normals(goldberg(3, 10).mesh));
};

TEST_F(HeldBall, counts_a_ghost_that_stays_after_the_hand_has_left) {
  const QueryOptions settling{}, leaping = test::leaping();
  const std::vector<Vec3> inside(40, Vec3(0, 0, 8));
  EXPECT_EQ(count_of(settling, inside, kConverged).contacts, 1u);
  EXPECT_EQ(count_of(settling, inside, 0).held, 0u);
  EXPECT_EQ(count_of(settling, inside, 0).longest, 0);
  const std::uint64_t bound = held_bound(settling.settle);
  EXPECT_EQ(bound, 26u);
  EXPECT_EQ(held_bound(leaping.settle), 1u);
  EXPECT_EQ(held_bound(settling.settle, 2.5e-4), 101u);
  for (const Vec3& aside : {Vec3(0, 0, 11), Vec3(13, 0, 3)}) {
    std::vector<Vec3> hips = inside;
    hips.insert(hips.end(), bound, aside);
    const HeldContacts fades = count_of(settling, hips, kSettling);
    EXPECT_EQ(fades.held, 0u);
    EXPECT_DOUBLE_EQ(fades.longest, 0.026);
    EXPECT_EQ(count_of(leaping, hips, 0).held, 1u);
    hips.push_back(aside);
    for (const std::uint32_t flags : {0u, kSettling, kConverged, kConverged | kSlipping}) {
      const bool pulls = aside.z() > 10;
      if (!pulls && flags != 0) continue;
      const HeldContacts stays = count_of(settling, hips, flags);
      EXPECT_EQ(stays.contacts, 1u);
      EXPECT_EQ(stays.held, 1u) << flags;
      EXPECT_DOUBLE_EQ(stays.longest, 0.027);
      EXPECT_EQ(stays.pulled, pulls ? 1u : 0u);
    }
  }
}

TEST_F(HeldBall, counts_a_contact_once) {
  std::vector<Vec3> hips;
  for (int times = 0; times < 3; ++times) {
    hips.insert(hips.end(), 5, Vec3(0, 0, 8));
    hips.insert(hips.end(), held_bound(QueryOptions{}.settle) + 1, Vec3(0, 0, 11));
  }
  EXPECT_EQ(count_of({}, hips, 0).contacts, 1u);
  EXPECT_EQ(count_of({}, hips, 0).held, 1u);
}

// The farthest point of the ball is as good a foot as the nearest, but no finger is held by it.
TEST_F(HeldBall, counts_a_finger_that_went_through_exactly_centrally) {
  const Contact top = nearest(cache_, {0, 0, 12});
  const std::vector<Vec3> behind(60, Vec3(top.scp - 50 * top.normal));
  EXPECT_EQ(count_of({}, behind, kConverged).held, 1u);
  EXPECT_EQ(count_of({}, behind, kConverged).pulled, 0u);
  EXPECT_EQ(count_of(test::leaping(), behind, kConverged).held, 1u);
}

// Presses from one place to another, outside too, and rests there.
void expect_held_justly(const PatchCache& cache, const QueryOptions& options, const Vec3& from,
                        const Vec3& to) {
  ContactTracker tracker(cache, options);
  HeldOutsideCounter counter(cache, options);
  std::vector<Vec3> hips = line(from, to, 500);
  hips.insert(hips.end(), 300, to);
  for (const Vec3& hip : hips) {
    const Contact contact = tracker.tick(hip);
    counter.add(hip, contact, contact);
  }
  EXPECT_TRUE(tracker.touching());
  EXPECT_FALSE(nearest(cache, to, options).touching);
  EXPECT_EQ(counter.count().contacts, 1u);
  EXPECT_EQ(counter.count().held, 0u);
  EXPECT_EQ(counter.count().longest, 0);
}

// A plate holds the finger that was pressed through it, however far, with friction too; and so does
// the valley between two cubes.
TEST(HeldOutside, counts_no_solid_that_holds_the_finger_pressed_through_it) {
  const Mesh mesh = test::with_normals(thin_plate().mesh);
  const Vec3 above(0.2, 0.1, 2), below(0.2, 0.1, -3);
  const PatchCache fair = test::cache_of(mesh),
                   base = build_base(mesh, build_topology(mesh), Precision::kDouble);
  for (const Method method : {Method::kGregory, Method::kFlat, Method::kShaded}) {
    for (const double friction : {0.0, 0.5}) {
      QueryOptions options = test::leaping(method);
      options.friction = {friction, friction};
      expect_held_justly(method == Method::kGregory ? fair : base, options, above, below);
    }
  }
  const Mesh box = gliss::cube(3, 20).mesh;
  const PatchCache two =
      build_cache(test::with_creases(test::joined({box, test::moved(box, Vec3(12, 12, 0.5))})));
  expect_held_justly(two, test::leaping(), {-1, 13, 0.3}, {13, -1.1, 0.4});
}

// A hand out of the object that is told again and again to feel this place, as from `near`.
HeldContacts held_at(const PatchCache& cache, const Vec3& near, const Vec3& hip,
                     std::uint32_t flags) {
  HeldOutsideCounter counter(cache, test::leaping());
  Contact contact = nearest(cache, near, test::leaping());
  contact.touching = true;
  contact.push = contact.scp - hip;
  contact.flags = flags;
  for (int i = 0; i < 60; ++i) counter.add(hip, contact, contact);
  return counter.count();
}

// The hand is beyond two plates: the far side of the farther one holds it, the near side of the
// same one pulls.
TEST(HeldOutside, counts_what_pulls_through_another_part) {
  const Mesh plate = test::with_normals(thin_plate().mesh);
  const PatchCache cache = test::cache_of(test::joined({plate, test::moved(plate, {0, 0, 3})}));
  const Vec3 hip(0.2, 0.1, 5);
  EXPECT_EQ(held_at(cache, {0.2, 0.1, -1}, hip, kConverged).held, 0u);
  EXPECT_EQ(held_at(cache, {0.2, 0.1, 1}, hip, kConverged).held, 1u);
  // The edge of the one pulls it through the other.
  const Mesh aside = test::moved(plate, {8, 0, 3});
  const PatchCache edged = test::cache_of(test::with_creases(test::joined({plate, aside})));
  const HeldContacts pulled =
      held_at(edged, {15.5, 0.1, 0.75}, {19.2, 0.1, 4.45}, kConverged | kOnCrease);
  EXPECT_EQ(pulled.held, 1u);
}

// On an edge of a box whose other places are nearer, no valley holds it.
TEST(HeldOutside, counts_an_edge_that_leads_on) {
  const PatchCache cache = test::cache_of(test::with_creases(gliss::cube(3, 10).mesh));
  const Box box = cache.bounds();
  const Vec3 middle = 0.5 * (box.low + box.high);
  const Vec3 below(middle.x(), middle.y(), box.low.z() - 1);
  const Vec3 edge(box.low.x() - 1, box.low.y() + 1, box.high.z() + 1);
  EXPECT_EQ(held_at(cache, edge, below, kConverged | kOnCrease).held, 1u);
}

// A surface that hands leave.
struct Left {
  std::string name;
  PatchCache cache;
  QueryOptions options;
};

// Constructions, levels, precisions and methods; with friction as well.
std::vector<Left> all_surfaces_of(const Mesh& mesh, const Mesh& creased) {
  std::vector<Left> all;
  const auto add = [&](const Level& level, Precision precision) {
    BuildOptions build;
    build.level = level;
    build.precision = precision;
    all.push_back({fmt::format("{}, {}", surface_name(level), precision_name(precision)),
                   build_cache(creased, build),
                   {}});
  };
  add({}, Precision::kDouble);
  add({}, Precision::kFloat);
  add({Level::kExact, 0, Construction::kPaper}, Precision::kDouble);
  add({Level::kBezier, 0, Construction::kPaper}, Precision::kDouble);
  for (const Method method : {Method::kShaded, Method::kFlat}) {
    all.push_back({std::string(method_name(method)),
                   build_base(mesh, build_topology(mesh), Precision::kDouble),
                   {{}, method}});
  }
  all.push_back({"friction", build_cache(creased), {}});
  all.back().options.friction = {0.8, 0.4};
  return all;
}

// Presses into, slides on and leaves a surface; with settle 0, 5 and 20 ms.
void expect_nothing_held(const std::string& name, const Left& surface, const Hands& hands) {
  for (const double settle : {0.0, 5e-3, 20e-3}) {
    QueryOptions options = surface.options;
    options.settle = settle;
    const HeldContacts felt = feel_leaving(surface.cache, options, hands);
    const std::string which = fmt::format("{}, {}, settle {} s", name, surface.name, settle);
    EXPECT_EQ(felt.held, 0u) << which << ": of " << felt.contacts << ", " << felt.longest << " s";
    EXPECT_EQ(felt.pulled, 0u) << which;
    EXPECT_GT(felt.contacts, hands.size() / 2) << which;
    test::record(which, "{} of {} contacts held outside, {} s at most", felt.held, felt.contacts,
                 felt.longest);
  }
}

void expect_nothing_held(const std::string& name, const Mesh& raw, bool has_creases = false) {
  const Mesh mesh = test::with_normals(raw);
  const Hands hands = hands_on(mesh, test::samples(20, 3000));
  for (const Left& surface : all_surfaces_of(mesh, has_creases ? test::with_creases(raw) : mesh))
    expect_nothing_held(name, surface, hands);
}

TEST(LeavingWalk, is_let_go_by_smooth_solids) {
  expect_nothing_held("ball", goldberg(3, 10).mesh);
  expect_nothing_held("knot", torus_knot().mesh);
  expect_nothing_held("banana", banana().mesh);
}

TEST(LeavingWalk, is_let_go_by_creases) {
  expect_nothing_held("cube", cube(3, 20).mesh, true);
  expect_nothing_held("prism", prism(5).mesh, true);
  expect_nothing_held("L", test::l_solid(), true);
}

// Patches of long faces, which turn and shorten by default: corners whose edges are not smooth, and
// searches that do not end within a tick.
TEST(LeavingWalk, is_let_go_by_needles) {
  Mesh mesh = prism(6, 0.5, 60).mesh;
  complete_mesh(mesh, Construction::kFair);
  expect_nothing_held("needle", {"fair, double", build_cache(mesh), {}},
                      hands_on(mesh, test::samples(20, 3000)));
}

TEST(LeavingWalk, is_let_go_by_parts_that_overlap) {
  const Mesh ball = goldberg(3, 10).mesh, box = cube(2, 16).mesh;
  expect_nothing_held("balls", test::joined({ball, test::moved(ball, Vec3(14, 0.4, 0.3))}));
  expect_nothing_held("ball in box", test::joined({box, test::moved(ball, Vec3(8, 8.2, 9))}));
}

TEST(LeavingWalk, is_let_go_by_thin_parts_and_rims) {
  expect_nothing_held("plate", thin_plate().mesh);
  expect_nothing_held("fin", fin().mesh);
  expect_nothing_held("sheet", test::sheet(1.5));
  expect_nothing_held("half torus", test::half_torus());
}

}  // namespace
}  // namespace gliss
