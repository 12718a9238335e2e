// The baselines, `flat` and `shaded`, are those of the mesh's polygons, whatever its creases and
// patches are.
#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/oracle/brute_force.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"

namespace gliss::test {
namespace {

constexpr Method kBaselines[] = {Method::kFlat, Method::kShaded};

// A solid that is the union of convex ones, each the planes that it lies beneath.
struct ExactSolid {
  Mesh mesh;
  std::vector<std::vector<std::pair<Vec3, double>>> parts;  // outward unit normal, height

  bool holds(const Vec3& x) const {
    return std::any_of(parts.begin(), parts.end(), [&](const auto& planes) {
      return std::all_of(planes.begin(), planes.end(),
                         [&](const auto& p) { return p.first.dot(x) < p.second; });
    });
  }
};

ExactSolid convex(const Mesh& mesh) {
  ExactSolid s{mesh, {{}}};
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corner = [&](std::uint32_t k) {
      return mesh.positions[mesh.corner_vertex[mesh.face_begin[f] + k]];
    };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    s.parts[0].emplace_back(normal, normal.dot(corner(0)));
  }
  return s;
}

Mesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Mesh mesh;
  mesh.source = "tetrahedron";
  mesh.positions = {a, b, c, d};
  add_face(mesh, {0, 2, 1});
  add_face(mesh, {0, 3, 2});
  add_face(mesh, {0, 1, 3});
  add_face(mesh, {1, 2, 3});
  return mesh;
}

// Both sides meet at x = 0 under an angle.
Mesh wedge(double angle) {
  Mesh mesh;
  mesh.source = "wedge";
  const double up = 2 * std::tan(angle / 2);
  for (const double y : {-1.0, 1.0})
    mesh.positions.insert(mesh.positions.end(), {{0, y, 0}, {2, y, up}, {2, y, -up}});
  add_face(mesh, {0, 1, 4, 3});
  add_face(mesh, {2, 0, 3, 5});
  add_face(mesh, {1, 2, 5, 4});
  add_face(mesh, {0, 2, 1});
  add_face(mesh, {3, 4, 5});
  return mesh;
}

std::vector<ExactSolid> exact_solids() {
  ExactSolid l{l_solid(), {}};
  for (const Vec3& high : {Vec3(2, 1, 1), Vec3(1, 2, 1)}) {
    l.parts.emplace_back();
    for (int i = 0; i < 3; ++i) {
      l.parts.back().emplace_back(-Vec3::Unit(i), 0.0);
      l.parts.back().emplace_back(Vec3::Unit(i), high[i]);
    }
  }
  return {convex(tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})),
          convex(wedge(2 * kDegree)), convex(cube()), l};
}

class Polygons : public ::testing::TestWithParam<Precision> {
 protected:
  static bool is_float() { return GetParam() == Precision::kFloat; }
};
INSTANTIATE_TEST_SUITE_P(, Polygons, ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

// At creases vertex normals are those of one face: they say nothing of the other's side.
TEST_P(Polygons, tell_inside_from_outside_at_creases) {
  for (const ExactSolid& solid : exact_solids()) {
    for (const Mesh& mesh : {solid.mesh, in_triangles(solid.mesh)}) {
      const PatchCache cache = cache_of(with_creases(mesh), GetParam());
      Rng rng(61);
      std::vector<Vec3> hips;
      for (int i = 0; i < 100'000; ++i) hips.push_back(random_in_box(rng, mesh, i % 2 ? 5 : 1.5));
      std::vector<Contact> found(2 * hips.size());
      nearest(cache, hips, kBaselines, {}, found);
      const double rounding = (is_float() ? 1e-6 : 1e-14) * size_of(mesh);
      int wrong = 0, inside = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::abs(found[i].distance) < rounding) continue;
        const bool is_inside = solid.holds(hips[i % hips.size()]);
        inside += is_inside;
        wrong += found[i].touching != is_inside;
      }
      EXPECT_EQ(wrong, 0) << mesh.source << ", " << mesh.face_count() << " faces";
      EXPECT_GT(inside, 500) << mesh.source;
    }
  }
}

TEST_P(Polygons, tell_so_from_tick_to_tick) {
  for (const ExactSolid& solid : exact_solids()) {
    const PatchCache cache = cache_of(with_creases(in_triangles(solid.mesh)), GetParam());
    for (const Method method : kBaselines) {
      Rng rng(62);
      for (int i = 0; i < 2000; ++i) {
        const Vec3 hip = random_in_box(rng, solid.mesh, i % 2 ? 5 : 1.5);
        ContactTracker tracker(cache, leaping(method));
        const Contact first = tracker.tick(hip), second = tracker.tick(hip),
                      tracked = tracker.track(hip, first.at);
        if (std::abs(first.distance) < 1e-6 * size_of(solid.mesh)) continue;
        for (const Contact& c : {first, second, tracked})
          ASSERT_EQ(c.touching, solid.holds(hip)) << solid.mesh.source << " " << hip.transpose();
      }
    }
  }
}

// Meshes whose patches fold, so that faces are cut round a centre off their polygons.
std::vector<Mesh> folding_meshes() {
  Rng rng(63);
  std::vector<Mesh> meshes{
      with_normals(tetrahedron({0, 0, 0}, {10, 0, 0}, {-3, 1, 0}, {4, 0.5, -3})),
      random_sphere(rng, 60, 1, 1.2)};
  for (Mesh mesh : {goldberg(2).mesh, prism(9).mesh}) {
    mesh.normals.clear();
    add_normals(mesh, rng, 1.4, [](const Vec3& p) { return p; });
    meshes.push_back(std::move(mesh));
  }
  return meshes;
}

// True if a face is cut round a centre.
bool is_fan(const PatchCache& cache, std::uint32_t face) {
  const std::uint32_t side = std::visit(
      [&](const auto& s) { return s.side_begin[cache.first_patch(face)]; }, cache.surface);
  return cache.corner_of_face[side + 2] == cache.face_valence[face];
}

// So the surface with split faces has the baselines of that without.
TEST_P(Polygons, are_the_same_where_faces_are_split) {
  for (const Construction construction : {Construction::kFair, Construction::kPaper}) {
    for (const Mesh& mesh : folding_meshes()) {
      const PatchCache split = cache_of(mesh, GetParam(), true, nullptr, construction),
                       whole = cache_of(mesh, GetParam(), false, nullptr, construction);
      int fans = 0;
      for (std::uint32_t f = 0; f < mesh.face_count(); ++f) fans += is_fan(split, f);
      ASSERT_GT(fans, 0) << mesh.source;
      Rng rng(64);
      std::vector<Vec3> hips;
      for (int i = 0; i < 3000; ++i) hips.push_back(random_in_box(rng, mesh, i % 3 ? 1.3 : 4));
      constexpr Method kAsked[] = {Method::kGregory, Method::kFlat, Method::kShaded};
      const std::size_t count = hips.size();
      std::vector<Contact> have(3 * count), want(3 * count);
      nearest(split, hips, kAsked, {}, have);
      nearest(whole, hips, kAsked, {}, want);
      const double size = size_of(mesh), rounding = is_float() ? 1e-6 : 1e-14;
      Worst distance, place, normal;
      int signs = 0, on_fans = 0;
      for (std::size_t i = count; i < 3 * count; ++i) {
        const Contact &a = have[i], &b = want[i];
        const Vec3& hip = hips[i % count];
        distance.add(std::abs(std::abs(a.distance) - std::abs(b.distance)) / size);
        distance.add(std::abs((a.scp - hip).norm() - std::abs(a.distance)) / size);
        QueryOptions alone;
        alone.method = kAsked[i / count];
        const Contact one = nearest(split, hip, alone);
        EXPECT_TRUE(one.scp == a.scp && one.push == a.push && one.at.xi == a.at.xi);
        signs += std::abs(b.distance) > rounding * size && a.touching != b.touching;
        if (a.at.face != b.at.face || (a.scp - b.scp).norm() > rounding * size ||
            !is_fan(split, a.at.face))
          continue;
        ++on_fans;
        place.add(std::hypot(a.at.xi - b.at.xi, a.at.eta - b.at.eta));
        normal.add((a.normal - b.normal).norm());
        // Tracked from there it stays.
        const Contact tracked = ContactTracker(split, leaping(alone.method)).track(hip, a.at);
        EXPECT_LE(std::abs(tracked.distance), std::abs(a.distance) + rounding * size);
        EXPECT_EQ(tracked.at.face, a.at.face);
      }
      record(mesh.source,
             "{} faces cut round a centre, {} contacts there; distance {:.2g}, place {:.2g}, "
             "normal {:.2g}",
             fans, on_fans, distance.value, place.value, normal.value);
      EXPECT_LE(distance.value, rounding) << mesh.source;
      EXPECT_EQ(signs, 0) << mesh.source;
      EXPECT_GT(on_fans, 50) << mesh.source;
      EXPECT_LE(place.value, 1e5 * rounding) << mesh.source;
      EXPECT_LE(normal.value, 1e5 * rounding) << mesh.source;
    }
  }
}

// Where every face is a triangle, brute force over these leaves no choice.
TEST_P(Polygons, of_split_faces_agree_with_brute_force) {
  const Mesh mesh = folding_meshes().front();
  const PatchCache cache = cache_of(mesh, GetParam());
  ASSERT_GT(cache.patch_count(), mesh.face_count());
  const std::vector<Triangle> triangles = triangles_of(mesh);
  Rng rng(65);
  QueryOptions options;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 hip = random_in_box(rng, mesh, 2);
    const double want = nearest_by_brute_force(triangles, hip).distance;
    for (const Method method : kBaselines) {
      options.method = method;
      ASSERT_NEAR(std::abs(nearest(cache, hip, options).distance), want,
                  (is_float() ? 1e-6 : 1e-14) * size_of(mesh));
    }
  }
}

}  // namespace
}  // namespace gliss::test
