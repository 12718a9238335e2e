// Contacts at creases: a concave one holds the SCP within the cone of its normals, and the force is
// continuous; a convex one is an edge, over which the force steps by no more than the angle asks.
#include <gtest/gtest.h>

#include "gliss/mesh/rounding.h"
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
  ContactTracker tracker(cache, leaping());
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

// The largest step of a tracked contact's push, and how far pushes are off a depth.
struct Slide {
  Worst step, off;
};
Slide slide(const PatchCache& cache, const std::vector<Vec3>& hips, double depth) {
  Slide found;
  ContactTracker tracker = arrived(cache, {0, 2, 11}, hips.front());
  Vec3 last = depth * Vec3::UnitZ();
  for (const Vec3& hip : hips) {
    const Contact contact = tracker.tick(hip);
    const Vec3 push = contact.touching ? contact.push : Vec3::Zero();
    found.step.add((push - last).norm() / depth);
    found.off.add(std::abs(push.norm() - depth) / depth);
    last = push;
  }
  return found;
}

// A finger slides 0.5 deep over an edge of a cube of side 20 and off it, where the force steps if
// the edge is sharp; and round the edge that a ball of 2 left, as deep all the way.
TEST(CreaseContact, a_rounded_edge_turns_the_force_without_a_step) {
  constexpr double kDepth = 0.5, kRadius = 2, kCentre = 10 - kRadius, kOut = kRadius - kDepth;
  const std::vector<Vec3> off = way({0, 2, 10 - kDepth}, {12, 2, 10 - kDepth}, 2400);
  std::vector<Vec3> round = way({0, 2, 10 - kDepth}, {kCentre, 2, 10 - kDepth}, 400);
  for (int i = 1; i <= 100; ++i) {
    const double angle = 90 * kDegree * i / 100;
    round.emplace_back(kCentre + kOut * std::sin(angle), 2, kCentre + kOut * std::cos(angle));
  }
  for (const Vec3& hip : way({10 - kDepth, 2, kCentre}, {10 - kDepth, 2, 0}, 400))
    round.push_back(hip);
  for (const Surface& s : surfaces_of(gliss::cube(1, 20).mesh)) {
    Mesh mesh = s.mesh;
    round_creases(mesh, kRadius * mesh.unit);
    BuildOptions options;
    options.level = s.cache.level;
    const PatchCache rounded = build_cache(mesh, options);
    const Slide sharp = slide(s.cache, off, kDepth), over = slide(rounded, off, kDepth),
                along = slide(rounded, round, kDepth);
    record(s.mesh.source + " " + surface_name(s.cache.level),
           "largest step of k d: sharp {:.3f}, rounded {:.4f}; round the edge {:.4f}, force {:.1e} "
           "off",
           sharp.step.value, over.step.value, along.step.value, along.off.value);
    EXPECT_GT(sharp.step.value, 0.9);
    EXPECT_LT(over.step.value, 0.2);
    EXPECT_LT(along.step.value, 0.03);  // 0.9 degrees a tick are 0.016
    EXPECT_LT(along.off.value, 0.02);
  }
}

// Whatever is near: the distance to a rounded cube, and to a rounded cylinder, is that to the
// middle of the ball less its radius, and what is within is touched.
TEST(CreaseContact, a_rounded_solid_is_where_the_ball_left_it) {
  using Distance = double (*)(const Vec3&);
  const auto outside = [](double x, double y, double z) {
    const Vec3 q(x, y, z);
    return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff()) - 2;
  };
  static const auto box = outside;
  const Distance cube = [](const Vec3& p) {
    return box(std::abs(p.x()) - 8, std::abs(p.y()) - 8, std::abs(p.z()) - 8);
  };
  const Distance cylinder = [](const Vec3& p) {
    return box(std::hypot(p.x(), p.y()) - 8, std::abs(p.z()) - 3, -1e9);
  };
  for (const auto& [shape, exact] :
       {std::pair(gliss::cube(2, 20).mesh, cube), std::pair(prism(32).mesh, cylinder)}) {
    for (const Surface& s : surfaces_of(shape)) {
      Mesh mesh = s.mesh;
      round_creases(mesh, 2 * mesh.unit);
      BuildOptions options;
      options.level = s.cache.level;
      const PatchCache cache = build_cache(mesh, options);
      oracle::Rng rng(3);
      Worst off, tracked;
      Vec3 at(0, 0, 9);
      ContactTracker tracker(cache, leaping());
      for (int leg = 0; leg < 300; ++leg) {
        Vec3 to;
        for (int i = 0; i < 3; ++i) to[i] = oracle::uniform(rng, -11, 11);
        if (leg % 3 == 0) to.y() = 0;  // through vertices of the rim
        const Contact found = nearest(cache, to);
        off.add(std::abs(found.distance - exact(to)));
        if (std::abs(exact(to)) > 0.05) {
          EXPECT_EQ(found.touching, exact(to) < 0) << to.transpose();
        }
        for (const Vec3& hip : way(at, to, 20)) {
          const Contact contact = tracker.tick(hip);
          // Within, a contact stays with its face; it is never nearer than the surface.
          if (contact.touching) tracked.add(-exact(hip) - contact.push.norm());
        }
        at = to;
      }
      record(s.mesh.source + " " + surface_name(s.cache.level),
             "nearest {:.1e}, pushes {:.1e} less than the depth", off.value, tracked.value);
      EXPECT_LT(off.value, 0.02 * 2);
      EXPECT_LT(tracked.value, 0.02 * 2);
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

// Faces that bend have edges too, in meshes without any crease: a contact at a corner goes on along
// the edge that leads down from there. Beside where it stays no way along the surface leads nearer
// to the HIP by a fifth of its length.
TEST(CreaseContact, goes_on_along_the_edges_of_bent_faces) {
  constexpr double kLeastFall = 0.2;  // of the way
  oracle::Rng rng(5);
  std::size_t on_edge = 0, bent = 0;
  for (const std::uint32_t points : {3u, 4u, 5u, 6u}) {
    const Mesh mesh = with_normals(star_prism(rng, points));
    const PatchCache cache = cache_of(mesh);
    for (const PatchKind kind : cache.kind) bent += kind == PatchKind::kBent;
    for (std::uint32_t i = 0; i < 500; ++i) {
      const Vec3 hip = 8 * oracle::uniform(rng, 0, 1) * oracle::random_unit(rng);
      const DomainPoint start{i % static_cast<std::uint32_t>(mesh.face_count()), 0, 0};
      Contact contact;
      track(cache, {&hip, 1}, {&start, 1}, {}, {&contact, 1});
      if ((contact.flags & kConverged) == 0 || (contact.flags & kOnCrease) == 0) continue;
      ++on_edge;
      const Vec3 out = (contact.scp - hip).normalized(), u = out.unitOrthogonal(), v = out.cross(u);
      const double push = (contact.scp - hip).norm(), round = 1e-3 * push;
      for (const Vec3& way : {u, v, Vec3(-u), Vec3(-v), Vec3(u + v), Vec3(u - v)}) {
        const Vec3 beside = nearest(cache, contact.scp + round * way).scp;
        EXPECT_GT((beside - hip).norm(), push - kLeastFall * round)
            << points << " points, HIP " << hip.transpose() << ", SCP " << contact.scp.transpose();
      }
    }
  }
  EXPECT_GT(bent, 0u);
  EXPECT_GT(on_edge, 100u);
}

}  // namespace
}  // namespace gliss::test
