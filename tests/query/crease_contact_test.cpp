// Contacts at creases: a concave one holds the SCP within the cone of its normals, and the force is
// continuous; a convex one is an edge, over which the force steps by no more than the angle asks.
#include <gtest/gtest.h>

#include "gliss/query/contact_tracker.h"
#include "gliss/surface/names.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss::test {
namespace {

struct Surface {
  Mesh mesh;
  PatchCache cache;
};

// In both constructions, as it is and in triangles.
std::vector<Surface> surfaces_of(const Mesh& shape, double angle = 40) {
  std::vector<Surface> all;
  for (const Construction construction : {Construction::kPaper, Construction::kFair}) {
    for (const Mesh& mesh : {shape, in_triangles(shape)}) {
      BuildOptions options;
      options.level.construction = construction;
      const Mesh marked = with_creases(mesh, {.angle = angle * kDegree});
      all.push_back({marked, build_cache(marked, options)});
    }
  }
  return all;
}

// HIPs from `from` to `to`.
std::vector<Vec3> way(const Vec3& from, const Vec3& to, int count) {
  std::vector<Vec3> hips;
  for (int i = 0; i <= count; ++i) hips.push_back(from + (to - from) * i / count);
  return hips;
}

// A tracker that has come from `outside` to `inside`.
ContactTracker arrived(const PatchCache& cache, const Vec3& outside, const Vec3& inside) {
  ContactTracker tracker(cache, {});
  for (const Vec3& hip : way(outside, inside, 50)) tracker.tick(hip);
  return tracker;
}

// An L, and a cube that one of its corners lacks: solids whose outside is convex beside the point
// (1, 1, 1). The nearest point to a HIP inside is the projection to that outside, from which the
// push has all that it should have: it changes by no more than the HIP moves.
TEST(CreaseContact, a_concave_crease_holds_the_contact_within_its_cone) {
  struct Case {
    Mesh mesh;
    Vec3 low, outside;  // of the notch; a place in it
  };
  for (const Case& c : {Case{l_solid(), {1, 1, -10}, {1.3, 1.3, 0.5}},
                        Case{corner_solid(), {1, 1, 1}, {1.3, 1.3, 1.3}}}) {
    for (const Surface& s : surfaces_of(c.mesh)) {
      oracle::Rng rng(11);
      const auto inside = [&] {  // within 0.1 of the notch's edges
        Vec3 hip;
        for (int i = 0; i < 3; ++i) hip[i] = c.low[i] < 0 ? 0.5 : oracle::uniform(rng, 0.9, 1.1);
        if ((hip.array() > c.low.array()).all()) hip[0] = 0.95;
        return hip;
      };
      Vec3 at = inside();
      ContactTracker tracker = arrived(s.cache, c.outside, at);
      Worst off, cone, step;
      Contact last = tracker.tick(at);
      std::size_t on_crease = 0, ticks = 0;
      for (int leg = 0; leg < 200; ++leg) {
        const Vec3 to = inside();
        // Straight on, but not through the notch.
        for (const Vec3& hip : way(at, to, 40)) {
          if ((hip.array() > c.low.array()).all()) break;
          const Vec3 scp = hip.cwiseMax(c.low);
          const Contact tracked = tracker.tick(hip), found = nearest(s.cache, hip);
          for (const Contact& contact : {tracked, found}) {
            ASSERT_TRUE(contact.touching) << s.mesh.source << " " << hip.transpose();
            off.add((contact.scp - scp).norm());
            cone.add(-std::min(0.0, contact.push.minCoeff()));
          }
          step.add((tracked.push - last.push).norm() - (hip - at).norm());
          on_crease += (tracked.flags & kOnCrease) != 0;
          ++ticks;
          last = tracked;
          at = hip;
        }
      }
      record(s.mesh.source + " " + surface_name(s.cache.level),
             "SCP {:.1e} off, force steps {:.1e} beyond the HIP's; {} of {} ticks on a crease",
             off.value, step.value, on_crease, ticks);
      EXPECT_GT(on_crease, ticks / 10);
      EXPECT_LT(off.value, 1e-7);
      EXPECT_LT(cone.value, 1e-7);
      EXPECT_LT(step.value, 1e-7);
    }
  }
}

// A prism's edges turn by 120, 90, 60, 45 degrees; HIPs `depth` beneath one of its sides pass the
// edge to the next one or leave the solid there.
TEST(CreaseContact, a_convex_crease_steps_by_no_more_than_its_angle_asks) {
  constexpr double kDepth = 0.5;
  constexpr int kTicks = 2000;
  for (const int sides : {3, 4, 6, 8}) {
    const double theta = 2 * std::numbers::pi / sides;
    for (const Surface& s : surfaces_of(prism(sides).mesh)) {
      const double apothem = 10 * std::cos(theta / 2), edge = 10 * std::sin(theta / 2);
      // Along the side whose normal is at theta / 2.
      const Vec3 n(std::cos(theta / 2), std::sin(theta / 2), 0), t(-n.y(), n.x(), 0);
      const auto place = [&](double along, double out) { return Vec3(along * t + out * n); };
      const Vec3 from = place(0, apothem - kDepth), to = place(edge + 2 * kDepth, apothem - kDepth);
      ContactTracker tracker = arrived(s.cache, place(0, apothem + 1), from);
      Vec3 tracked = Vec3::Zero(), found = Vec3::Zero();
      Worst tracked_step, found_step;
      for (const Vec3& hip : way(from, to, kTicks)) {
        const Contact a = tracker.tick(hip), b = nearest(s.cache, hip);
        const Vec3 push_a = a.touching ? a.push : Vec3::Zero(),
                   push_b = b.touching ? b.push : Vec3::Zero();
        if (hip != from) {
          tracked_step.add((push_a - tracked).norm());
          found_step.add((push_b - found).norm());
        }
        tracked = push_a, found = push_b;
      }
      const double most = 2 * kDepth * std::sin(theta / 2) + (to - from).norm() / kTicks;
      record(fmt::format("{} {:.0f} degrees", surface_name(s.cache.level), theta / kDegree),
             "track {:.4f}, nearest {:.4f}, law {:.4f} of the depth", tracked_step.value / kDepth,
             found_step.value / kDepth, most / kDepth);
      EXPECT_LE(tracked_step.value, most);
      EXPECT_LE(found_step.value, most);
      EXPECT_GT(found_step.value, 0.9 * most);  // of two faces the nearer one: there the law is met
    }
  }
}

// Whatever is near: the nearest point of a solid of flat faces is that of its polygons.
TEST(CreaseContact, nearest_points_are_those_of_the_flat_solid) {
  for (const Mesh& shape : {cube(), l_solid(), corner_solid(), prism(7).mesh}) {
    for (const Surface& s : surfaces_of(shape)) {
      oracle::Rng rng(7);
      const Box box = s.cache.bounds();
      const Vec3 middle = (box.low + box.high) / 2, half = 0.7 * (box.high - box.low);
      Worst off;
      for (int i = 0; i < 300; ++i) {
        Vec3 hip = middle;
        for (int axis = 0; axis < 3; ++axis) hip[axis] += half[axis] * oracle::uniform(rng, -1, 1);
        QueryOptions flat;
        flat.method = Method::kFlat;
        const Contact smooth = nearest(s.cache, hip), base = nearest(s.cache, hip, flat);
        off.add(std::abs(std::abs(smooth.distance) - std::abs(base.distance)));
        EXPECT_EQ(smooth.touching, base.touching) << shape.source << " " << hip.transpose();
      }
      EXPECT_LT(off.value, 1e-7 * size_of(s.mesh)) << shape.source;
    }
  }
}

}  // namespace
}  // namespace gliss::test
