// Patches that a worker builds ahead of a hand: the forces of the whole cache where they are there,
// the base polygons on the same side where they are not.
#include "gliss/contact/lazy_contact.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

#include <atomic>
#include <cstring>
#include <numbers>
#include <numeric>
#include <optional>
#include <thread>

#include "gliss/contact/tracker.h"
#include "gliss/generate/generate.h"
#include "gliss/thread/periodic.h"
#include "tests/support/allocations.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using oracle::Rng;

// A knot of several thousand patches.
const Generated& knot() {
  static const Generated made = torus_knot(360, 16);
  return made;
}
std::shared_ptr<const LazyMesh> lazy_knot(Precision precision = Precision::kDouble) {
  return std::make_shared<const LazyMesh>(knot().mesh, LazyOptions{3, precision});
}
const PatchCache& whole_knot() {
  static const PatchCache cache = test::cache_of(knot().mesh);
  return cache;
}

// Down onto the tube from 3 mm above it, and along and round it 2 mm beneath; mm, a point each
// 0.1 mm or so.
std::vector<Vec3> way_on_knot(double step, std::size_t ticks) {
  std::vector<Vec3> path;
  const auto start = knot().exact->nearest(knot().mesh.positions[0]);
  for (double height = 3; height > -2; height -= step)
    path.push_back(start.position + height * start.normal);
  Vec3 at = start.position, heading = start.normal.unitOrthogonal();
  while (path.size() < ticks) {
    const auto p = knot().exact->nearest(at);
    heading = (heading - heading.dot(p.normal) * p.normal).normalized();
    // A slow turn, so that it goes along and round.
    heading = Eigen::AngleAxisd(0.004 * step, p.normal) * heading;
    path.push_back(p.position - 2 * p.normal);
    at = p.position + step * heading;
  }
  return path;
}

// Goes to a HIP again and again until the worker has nothing more to build for it.
Contact settle(LazyContact& contact, const Vec3& hip) {
  Contact last;
  std::uint64_t regions = ~0ull;
  do {
    regions = contact.worker().regions();
    for (int i = 0; i < 10; ++i) {
      contact.post(hip);
      last = contact.tick(hip);
      std::this_thread::sleep_for(1ms);
    }
  } while (contact.worker().regions() != regions || (last.flags & kNotBuilt));
  return last;
}

// Lets the worker build, or not.
class Gate {
 public:
  LazyWorkerOptions options() {
    LazyWorkerOptions options;
    options.before_build = [this] {
      while (shut) std::this_thread::sleep_for(100us);
    };
    return options;
  }
  std::atomic<bool> shut{false};
};

TEST(LazyMesh, builds_the_bytes_of_the_whole_cache) {
  // With folded patches too, which are split or bent.
  for (const Mesh& mesh :
       {knot().mesh, test::with_normals(fin().mesh), irregular(torus(), 1).mesh}) {
    const LazyMesh lazy(mesh);
    const PatchCache whole = build_cache(mesh);
    const auto& all = std::get<1>(whole.surface);
    Rng rng(1);
    for (int i = 0; i < 20; ++i) {
      const auto face = static_cast<std::uint32_t>(rng() % mesh.face_count());
      const LazyRegion region = lazy.build({&face, 1});
      const auto& s = std::get<1>(region.cache.surface);
      EXPECT_TRUE(region.covers(face));
      for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
        const std::uint32_t f = region.cache.patch_face[p],
                            q = whole.first_patch(f) + p - region.cache.first_patch(f);
        ASSERT_EQ(s.valence(p), all.valence(q));
        const auto same = [&](const auto& a, const auto& b, std::size_t at, std::size_t in_all,
                              std::size_t count) {
          return std::memcmp(&a[at], &b[in_all], count * sizeof(double)) == 0;
        };
        const std::size_t begin = s.side_begin[p], in_all = all.side_begin[q], n = s.valence(p);
        ASSERT_EQ(s.form[p], all.form[q]);
        EXPECT_TRUE(same(s.control, all.control, 3 * std::size_t{s.control_begin[p]},
                         3 * std::size_t{all.control_begin[q]},
                         kernels<double>().control_reals(s.form[p], s.valence(p))));
        EXPECT_TRUE(same(s.corner, all.corner, begin * 6, in_all * 6, n * 6));
        EXPECT_TRUE(same(s.patch, all.patch, p * kPatchReals, q * kPatchReals, kPatchReals));
        if (!region.used[p]) continue;
        for (std::size_t k = 0; k < n; ++k) {
          const std::uint32_t twin = s.side_twin[begin + k], real = all.side_twin[in_all + k];
          ASSERT_EQ(twin == kNone, real == kNone);
          if (twin == kNone) continue;
          EXPECT_EQ(region.cache.patch_face[s.side_patch[twin]],
                    whole.patch_face[all.side_patch[real]]);
        }
      }
    }
  }
}

TEST(LazyMesh, reaches_farther_than_its_patches) {
  const Mesh meshes[] = {knot().mesh,   goldberg(1).mesh,  banana().mesh,
                         prism(8).mesh, prism(3).mesh,     torus().mesh,
                         fin().mesh,    thin_plate().mesh, torus_knot().mesh};
  double most = 0;
  for (const Mesh& mesh : meshes) {
    const PatchCache cache = test::cache_of(mesh);
    const auto& s = std::get<1>(cache.surface);
    const double reach = LazyMesh(mesh).reach();
    for (std::uint32_t p = 0; p < cache.patch_count(); ++p) {
      const double* numbers = &s.patch[p * kPatchReals];
      most = std::max(most, numbers[kPatchSag] * numbers[kPatchUnscale] / cache.scale / reach);
    }
  }
  EXPECT_LT(most, 1);
  test::record("largest sag", "{:.2f} of the reach", most);
}

TEST(LazyContact, is_the_contact_of_the_whole_cache_where_the_worker_keeps_up) {
  LazyContact lazy(lazy_knot(), {});
  ContactTracker whole(whole_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 3000);
  std::size_t late = 0, touching = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i % 10 == 0) settle(lazy, path[i]);
    lazy.post(path[i]);
    const Contact want = whole.tick(path[i]), got = lazy.tick(path[i]);
    late += (got.flags & kNotBuilt) != 0;
    touching += got.touching;
    if (want.distance > 1) continue;  // too far away to matter
    ASSERT_EQ(got.touching, want.touching) << i;
    // A HIP that stays where it is converges further, which the whole cache's has not done.
    ASSERT_LT((got.push - want.push).norm(), 1e-7) << i;
  }
  EXPECT_EQ(late, 0u);
  EXPECT_GT(touching, path.size() * 9 / 10);
  EXPECT_LT(lazy.worker().held(), 8u);
}

// Base polygons that stand in, and patches that come after: the point of the other surface that
// lags as far goes on.
TEST(LazyContact, rubs_on_where_one_surface_stands_in_for_the_other) {
  QueryOptions rubbing;
  rubbing.friction = {0.5, 0.3};
  Gate gate;
  LazyContact lazy(lazy_knot(), rubbing, gate.options());
  const std::vector<Vec3> path = way_on_knot(0.05, 3000);
  constexpr std::size_t kRubs = 120;  // the HIP is pressed down before, straight
  Contact last;
  std::size_t changes = 0, slips = 0, touching = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    gate.shut = i / 300 % 2 == 1;
    if (!gate.shut && i % 10 == 0) settle(lazy, path[i]);
    lazy.post(path[i]);
    const Contact now = lazy.tick(path[i]);
    if (last.touching && now.touching && i % 10 != 0) {
      const double way = (path[i] - path[i - 1]).norm();
      const bool changes_surface = ((now.flags ^ last.flags) & kNotBuilt) != 0;
      changes += changes_surface;
      // The cone bounds it on patches; Settling over edges of base polygons, and what their shapes
      // differ by where they change.
      const bool leaps = changes_surface || (now.flags & kNotBuilt) != 0;
      const double lag = way * 0.5 + 0.2 * 2;
      const double most = leaps ? 10 * way + 3 * lag : way + lag;
      EXPECT_LE((now.push - last.push).norm(), most) << i;
      if (i > kRubs && !is_settling(now.flags)) {
        EXPECT_GT(lazy.tracker().cone_share(), 0.3) << i;
      }
      slips += is_slipping(now.flags);
      ++touching;
    }
    last = now;
  }
  gate.shut = false;
  EXPECT_GT(touching, path.size() * 3 / 4);
  EXPECT_GT(slips, touching / 2);
  test::record("surfaces change", "{} times in {} ticks, {} slip", changes, touching, slips);
}

// Goes along the knot beside the whole cache's contact; false where the worker was late, which
// tells nothing. `patience`: how long it is given.
bool is_carried_along(int patience) {
  LazyContact lazy(lazy_knot(), {});
  ContactTracker whole(whole_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 3000);
  std::size_t same = 0, asked = 0;
  double most = 0;
  for (const Vec3& hip : path) {
    // The worker is told of every HIP long before the tick.
    const std::uint64_t regions = lazy.worker().regions();
    lazy.post(hip);
    for (int i = 0; i < 5 || (i < 20 && lazy.worker().regions() != regions); ++i)
      std::this_thread::sleep_for(patience * 200us);
    const Contact want = whole.tick(hip), got = lazy.tick(hip);
    if (want.distance > 1) continue;
    if (got.flags & kNotBuilt) return false;
    ++asked;
    // A vertex is as near on each of its faces, and roundings differ after another.
    most = std::max(most, (got.scp - want.scp).norm());
    same += got.iterations == want.iterations;
  }
  EXPECT_LT(most, 1e-9);
  // Without the curvature and the drift of the last tick it would take more.
  EXPECT_GE(same, asked - 20);
  EXPECT_GT(lazy.worker().regions(), 20u);
  test::record("regions",
               "{:.2g} mm off, {} of {} ticks as many iterations; {} of {} patches each, of {}",
               most, same, asked, lazy.worker().regions(),
               lazy.worker().patches() / lazy.worker().regions(), whole_knot().patch_count());
  return true;
}

TEST(LazyContact, carries_its_state_from_region_to_region) {
  EXPECT_TRUE(is_carried_along(1) || is_carried_along(4) || is_carried_along(16));
}

TEST(LazyContact, keeps_ahead_of_a_hand_in_real_time) {
  for (const double speed : {0.1, 0.5}) {  // mm a tick, m/s
    LazyContact lazy(lazy_knot(), test::leaping());
    ContactTracker whole(whole_knot(), test::leaping());
    const std::vector<Vec3> path = way_on_knot(speed, 3000);
    std::size_t late = 0, late_in_contact = 0, missed = 0;
    double worst = 0, worst_late = 0;
    std::uint64_t allocations = test::allocations();
    PeriodicTimer timer(1ms);
    for (const Vec3& hip : path) {
      timer.wait();
      lazy.post(hip);
      if (lazy.is_clear(hip)) continue;
      const Contact got = lazy.tick(hip), want = whole.tick(hip);
      const bool stood_in = (got.flags & kNotBuilt) != 0;
      late += stood_in;
      late_in_contact += stood_in && got.touching;
      missed += want.distance < -0.5 && !got.touching;
      double& most = stood_in ? worst_late : worst;
      most = std::max(most, (got.push - want.push).norm());
    }
    allocations = test::allocations() - allocations;
    EXPECT_EQ(missed, 0u);
    EXPECT_EQ(allocations, 0u);
    EXPECT_LT(worst, 1e-7);
    EXPECT_LT(worst_late, 1.0);
    EXPECT_LT(late, path.size() / 2);
    const auto& worker = lazy.worker();
    test::record(
        fmt::format("{} m/s", speed),
        "{} of {} ticks on the base polygons, {} in contact, {:.1e} mm off; {:.1e} mm else; {} "
        "regions of {} patches",
        late, path.size(), late_in_contact, worst_late, worst, worker.regions(),
        worker.patches() / std::max<std::uint64_t>(1, worker.regions()));
  }
}

TEST(LazyContact, goes_on_with_base_polygons_while_the_worker_is_held_up) {
  Gate gate;
  LazyContact lazy(lazy_knot(), {}, gate.options());
  ContactTracker whole(whole_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 2000);
  const double stiffness = 0.5;  // N/mm
  double most_step = 0, most_want = 0;
  std::size_t late = 0, returns = 0;
  bool was_late = false;
  Vec3 last = Vec3::Zero(), last_want = Vec3::Zero();
  settle(lazy, path[0]);
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i % 400 == 100) gate.shut = true;
    lazy.post(path[i]);
    if (i % 400 == 300) {
      gate.shut = false;
      settle(lazy, path[i]);
    }
    const Contact got = lazy.tick(path[i]), want = whole.tick(path[i]);
    const bool is_late = (got.flags & kNotBuilt) != 0;
    ASSERT_TRUE(got.touching || want.distance > -0.2) << i;
    returns += was_late && !is_late;
    late += is_late;
    if (i > 0) {
      most_step = std::max(most_step, stiffness * (got.push - last).norm());
      most_want = std::max(most_want, stiffness * (want.push - last_want).norm());
    }
    was_late = is_late;
    last = got.push;
    last_want = want.push;
    if (i % 400 < 100 || i % 400 > 300) std::this_thread::sleep_for(1ms);
  }
  gate.shut = false;
  EXPECT_GT(late, 100u);
  EXPECT_GT(returns, 0u);
  EXPECT_LT(most_step, 0.15);  // 2 x 0.1 mm and 4 % of 2 mm, where polygons and patches change
  test::record("held up", "{} of {} ticks late; steps of at most {:.3f} N, {:.3f} N without", late,
               path.size(), most_step, most_want);
}

// Top and bottom are 0.5 mm apart; the hand goes 5 mm deep, and there the worker comes and goes.
TEST(LazyContact, stays_on_its_side_of_a_plate) {
  for (const bool built_before : {false, true}) {
    Gate gate;
    gate.shut = !built_before;
    const auto mesh = std::make_shared<const LazyMesh>(thin_plate(40, 40).mesh);
    LazyContact lazy(mesh, {}, gate.options());
    const Box box = mesh->base().bounds();
    const double top = box.high.z();
    const Vec3 over(box.low.x() + 5, 0.5 * (box.low.y() + box.high.y()), top + 2);
    if (built_before) settle(lazy, over);
    const auto tick = [&](const Vec3& hip) {
      lazy.post(hip);
      return lazy.tick(hip);
    };
    Vec3 hip = over;
    for (int i = 0; i < 70; ++i) {
      hip.z() -= 0.1;
      const Contact contact = tick(hip);
      if (hip.z() < top - 0.1) {
        ASSERT_TRUE(contact.touching) << i;
        ASSERT_GT(contact.push.z(), 0) << i;
      }
    }
    for (int i = 0; i < 200; ++i) {
      gate.shut = i % 50 < 25;
      hip.x() += 0.1;
      const Contact contact = tick(hip);
      ASSERT_TRUE(contact.touching) << i;
      ASSERT_NEAR(contact.push.z(), top - hip.z(), 0.2) << i;
      if (!gate.shut) std::this_thread::sleep_for(500us);
    }
    gate.shut = false;
    const Contact back = settle(lazy, hip);
    EXPECT_EQ(back.flags & kNotBuilt, 0u);
    EXPECT_NEAR(back.push.z(), top - hip.z(), 0.2);
  }
}

// Through a plate between two ticks, where nothing is built at all.
TEST(LazyContact, no_speed_tunnels_through_a_plate) {
  Gate gate;
  gate.shut = true;
  const auto mesh = std::make_shared<const LazyMesh>(thin_plate(40, 40).mesh);
  LazyContact lazy(mesh, {}, gate.options());
  const Vec3 centre = 0.5 * (mesh->base().bounds().low + mesh->base().bounds().high);
  EXPECT_FALSE(lazy.tick(centre + Vec3(0.1, 0.2, 5)).touching);
  const Contact contact = lazy.tick(centre - Vec3(0.1, 0.2, 3));
  EXPECT_TRUE(contact.touching);
  EXPECT_GT(contact.push.z(), 3);
  EXPECT_TRUE(contact.flags & kNotBuilt);
  gate.shut = false;
}

// A worker that was sent elsewhere meanwhile has built what the contact is not on.
TEST(LazyContact, keeps_its_patches_where_a_new_region_lacks_them) {
  LazyContact lazy(lazy_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 2000);
  Vec3 hip = path[100];
  ASSERT_TRUE(settle(lazy, hip).touching);
  const std::uint64_t regions = lazy.worker().regions();
  while (lazy.worker().regions() == regions) {
    lazy.post(path.back());
    std::this_thread::sleep_for(1ms);
  }
  for (int i = 0; i < 5; ++i) {
    const Contact contact = lazy.tick(hip += Vec3(1e-3, 0, 0));
    EXPECT_TRUE(contact.touching);
    EXPECT_EQ(contact.flags & kNotBuilt, 0u) << i;
  }
}

// The contact keeps only the last one of the regions that came and were of no use.
TEST(LazyContact, gives_back_regions_that_it_never_used) {
  LazyContact lazy(lazy_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 2000);
  ASSERT_TRUE(settle(lazy, path[100]).touching);
  const std::uint64_t before = lazy.worker().regions();
  for (std::size_t i = 1000; i < path.size(); i += 100) {
    const std::uint64_t regions = lazy.worker().regions();
    for (int tries = 0; tries < 200 && lazy.worker().regions() == regions; ++tries) {
      lazy.post(path[i]);
      std::this_thread::sleep_for(1ms);
    }
    ASSERT_TRUE(lazy.tick(path[100]).touching);
  }
  EXPECT_GT(lazy.worker().regions(), before + 4);
  // That of the contact, the last one that was taken, and the last one that was built.
  for (int i = 0; i < 100 && lazy.worker().held() > 3; ++i) std::this_thread::sleep_for(1ms);
  EXPECT_LE(lazy.worker().held(), 3u);
}

// Patches stand out of their polygons by no more than the mesh's reach.
TEST(LazyContact, is_clear_of_patches_not_of_polygons_alone) {
  LazyContact lazy(lazy_knot(), {});
  const double reach = lazy_knot()->reach();
  const auto start = knot().exact->nearest(knot().mesh.positions[0]);
  const auto above = [&](double height) -> Vec3 { return start.position + height * start.normal; };
  const double far = lazy.tick(above(5 * reach)).distance;
  EXPECT_TRUE(lazy.is_clear(above(5 * reach - 0.9 * (far - reach))));
  EXPECT_FALSE(lazy.is_clear(above(5 * reach - far + 0.5 * reach)));
  // It is clear of nothing where it may meet a patch.
  const Contact near = lazy.tick(above(0.5 * reach));
  EXPECT_FALSE(near.touching);
  EXPECT_FALSE(lazy.is_clear(above(0.5 * reach)));
}

// A patch that stands out of its polygon is touched before that is.
TEST(LazyContact, touches_patches_above_their_polygons) {
  const auto mesh = std::make_shared<const LazyMesh>(goldberg(1).mesh);
  LazyContact lazy(mesh, {});
  const PatchCache cache = test::cache_of(goldberg(1).mesh);
  const SurfacePoint top = test::at(cache, 0, {0, 0});
  const auto at = [&](double height) -> Vec3 { return top.position + height * top.normal; };
  const Vec3 within = at(-0.1);
  QueryOptions flat;
  flat.method = Method::kFlat;
  ASSERT_GT(ContactTracker(mesh->base(), flat).tick(within).distance, 0);
  settle(lazy, at(0.1));
  EXPECT_FALSE(lazy.tick(at(0.01)).touching);
  EXPECT_TRUE(lazy.tick(within).touching);
}

// Patches that come while a position is late take up where the hand was.
TEST(LazyContact, no_speed_tunnels_where_a_position_is_no_number) {
  const auto mesh = std::make_shared<const LazyMesh>(thin_plate(40, 40).mesh);
  LazyContact lazy(mesh, {});
  const Vec3 centre = 0.5 * (mesh->base().bounds().low + mesh->base().bounds().high);
  EXPECT_FALSE(lazy.tick(centre + Vec3(0.1, 0.2, 5)).touching);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(lazy.tick({nan, nan, nan}).touching);
  while (lazy.worker().regions() == 0) {
    lazy.post(centre + Vec3(0.1, 0.2, 0.5));
    std::this_thread::sleep_for(1ms);
  }
  const Contact contact = lazy.tick(centre - Vec3(0.1, 0.2, 3));
  EXPECT_TRUE(contact.touching);
  EXPECT_GT(contact.push.z(), 3);
  EXPECT_EQ(contact.flags & kNotBuilt, 0u);
}

TEST(LazyContact, takes_friction_in_contact) {
  LazyContact lazy(lazy_knot(), {});
  const std::vector<Vec3> path = way_on_knot(0.1, 400);
  std::size_t slips = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i % 10 == 0) settle(lazy, path[i]);
    if (i == 200) {
      ASSERT_TRUE(lazy.set_friction({0.5, 0.3}));
    }
    lazy.post(path[i]);
    const Contact contact = lazy.tick(path[i]);
    if (!(contact.flags & kNotBuilt)) slips += is_slipping(contact.flags);
  }
  EXPECT_GT(slips, 50u);
}

TEST(LazyContact, stands_in_with_shaded_polygons) {
  Gate gate;
  gate.shut = true;
  const auto mesh = lazy_knot();
  LazyContact lazy(mesh, {}, gate.options());
  QueryOptions shaded;
  shaded.method = Method::kShaded;
  ContactTracker polygons(mesh->base(), shaded);
  for (const Vec3& hip : way_on_knot(0.1, 200)) {
    const Contact got = lazy.tick(hip), want = polygons.tick(hip);
    ASSERT_EQ(got.touching, want.touching);
    if (got.touching) {
      ASSERT_EQ(got.push, want.push);
    }
  }
  EXPECT_TRUE(lazy.touching());
  gate.shut = false;
}

// The contact with the polygons of one side, before there were patches, is over when the hand has
// let go.
TEST(LazyContact, goes_round_a_plate_that_it_has_touched_by_its_polygons) {
  Gate gate;
  gate.shut = true;
  const auto mesh = std::make_shared<const LazyMesh>(thin_plate(40, 40).mesh);
  LazyContact lazy(mesh, {}, gate.options());
  const Box box = mesh->base().bounds();
  const double rim = box.low.x(), y = 0.5 * (box.low.y() + box.high.y());
  for (double z = box.high.z() + 1; z > box.high.z() - 0.1; z -= 0.1) lazy.tick({rim + 3, y, z});
  ASSERT_TRUE(lazy.touching());
  gate.shut = false;
  ASSERT_TRUE(settle(lazy, {rim + 3, y, box.high.z() - 0.1}).touching);
  gate.shut = true;
  ASSERT_FALSE(lazy.tick({rim - 1, y, 0.5 * (box.low.z() + box.high.z())}).touching);
  EXPECT_FALSE(lazy.tick({rim + 2, y + 10, box.low.z() - 1}).touching);
  gate.shut = false;
}

TEST(LazyContact, builds_nothing_far_from_a_surface_and_little_near_it) {
  LazyContact lazy(lazy_knot(), {});
  for (int i = 0; i < 50; ++i) {
    const Vec3 hip(0, 0, 60 + i * 0.01);
    lazy.post(hip);
    lazy.tick(hip);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(lazy.worker().regions(), 0u);
  settle(lazy, knot().mesh.positions[100]);
  EXPECT_GT(lazy.worker().regions(), 0u);
  EXPECT_LT(lazy.worker().patches(), whole_knot().patch_count() / 20);
}

TEST(LazyContact, begins_and_ends_at_any_moment) {
  const std::shared_ptr<const LazyMesh> meshes[] = {
      std::make_shared<const LazyMesh>(goldberg().mesh),
      std::make_shared<const LazyMesh>(goldberg().mesh, LazyOptions{2, Precision::kFloat})};
  Rng rng(5);
  for (int i = 0; i < 1000; ++i) {
    LazyContact lazy(meshes[i % 2], {});
    const int ticks = static_cast<int>(rng() % 8);
    for (int t = 0; t < ticks; ++t) {
      const Vec3 hip(0.3 * t, 0.1, 9.5);
      lazy.post(hip);
      EXPECT_TRUE(lazy.tick(hip).touching);
      std::this_thread::sleep_for(std::chrono::microseconds(rng() % 300));
    }
  }
}

TEST(LazyContact, ends_a_build_that_takes_long) {
  constexpr int kSides = 400;
  Mesh disk;
  for (int i = 0; i < kSides; ++i) {
    const double turn = 2 * std::numbers::pi * i / kSides;
    disk.positions.emplace_back(std::cos(turn), std::sin(turn), 0.01 * (i % 2));
  }
  disk.corner_vertex.resize(kSides);
  std::iota(disk.corner_vertex.begin(), disk.corner_vertex.end(), 0u);
  disk.face_begin.push_back(kSides);
  std::atomic<bool> begun = false;
  LazyWorkerOptions options;
  options.before_build = [&] { begun = true; };
  const auto mesh = std::make_shared<const LazyMesh>(disk);
  std::optional<LazyWorker> worker(std::in_place, mesh, options);
  while (!begun) {
    worker->post({0.1, 0, 0.001}, false, 0);
    std::this_thread::sleep_for(1ms);
  }
  std::this_thread::sleep_for(20ms);
  const Nanoseconds start = monotonic_time();
  worker.reset();
  EXPECT_LT(in_seconds(monotonic_time() - start), 0.5);
}

TEST(LazyContact, bears_hips_that_are_none) {
  LazyContact lazy(lazy_knot(), {});
  const Vec3 hip = way_on_knot(0.1, 100).back();
  EXPECT_TRUE(settle(lazy, hip).touching);
  const Vec3 none = Vec3::Constant(std::nan(""));
  lazy.post(none);
  lazy.tick(none);
  const Contact after = settle(lazy, hip);
  EXPECT_TRUE(after.touching);
  EXPECT_TRUE(after.push.allFinite());
}

TEST(Tracker, renders_objects_whose_patches_are_built_near_the_hand) {
  SceneObject object;
  object.lazy = std::make_shared<const LazyMesh>(goldberg().mesh);
  object.stiffness = 700;
  object.settle = 0;  // else a hand that rests feels little more than the polygons that stood in
  object.pose = Eigen::Translation3d(0.1, -0.2, 0.3) * Eigen::AngleAxisd(1.1, Vec3::UnitX());
  SceneObject whole = object;
  whole.cache = std::make_shared<PatchCache>(test::cache_of(goldberg().mesh));
  const Vec3 hips[] = {Vec3::Zero(), Vec3(0.001, 0, 0)};
  Tracker lazy({&object, 1}, hips), all({&whole, 1}, hips);
  EXPECT_EQ(lazy.unit(0), 1e-3);
  const Vec3 at = object.pose * Vec3(0, 0, 0.009);
  const Vec3 want = all.step(at);
  Vec3 got;
  for (int i = 0; i < 10000; ++i) {
    got = lazy.step(at);
    if (!((lazy.objects()[0].contact.flags | lazy.objects()[1].contact.flags) & kNotBuilt)) break;
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(lazy.touching());
  EXPECT_LT((got - want).norm(), 1e-9);
}

}  // namespace
}  // namespace gliss
