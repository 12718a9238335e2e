// Forces of gregory, shaded and flat: direction, size, and how they change along a path.
#include <numbers>

#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "gliss/query/trace.h"
#include "gliss/surface/names.h"
#include "gliss/tables/csv_reader.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng;
using test::Worst;

constexpr double kStiffness = 500;  // N/m

Contact nearest_by(const PatchCache& cache, Method method, const Vec3& hip) {
  QueryOptions options;
  options.method = method;
  return nearest(cache, hip, options);
}

constexpr Method kMethods[] = {Method::kGregory, Method::kShaded, Method::kFlat};

TEST(Method, all_push_straight_out_of_a_plane) {
  const Mesh mesh = test::with_normals(thin_plate(12, 12, 30, 5).mesh);
  const PatchCache cache = test::cache_of(mesh);
  Rng rng(61);
  for (const Method method : kMethods) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 on_axis(oracle::uniform(rng, -9, 9), oracle::uniform(rng, -9, 9), 0);
      const Vec3 inside = on_axis + Vec3(0, 0, cache.bounds().high.z() - 0.1);
      const Vec3 pushed = contact_force(cache, nearest_by(cache, method, inside), kStiffness);
      EXPECT_LE((pushed - Vec3(0, 0, kStiffness * 1e-4)).norm(), 1e-12);
      const Vec3 outside = inside + Vec3(0, 0, 0.2);
      EXPECT_EQ(contact_force(cache, nearest_by(cache, method, outside), kStiffness).norm(), 0);
    }
  }
}

TEST(Method, forces_are_stiffness_times_depth_along_what_each_calls_its_normal) {
  Rng rng(62);
  const struct {
    Generated made;
    double gregory;  // off the exact surface's force, at most
  } cases[] = {{goldberg(), 0.09}, {torus_knot(), 0.015}};
  for (const auto& [made, most] : cases) {
    const PatchCache cache = test::cache_of(made.mesh);
    Worst gregory_error, shaded_angle;
    for (int i = 0; i < 2000; ++i) {
      const auto face = static_cast<std::uint32_t>(rng() % made.mesh.face_count());
      const auto X = oracle::random_inside<double>(rng, static_cast<int>(made.mesh.valence(face)));
      const SurfacePoint point = test::at(cache, face, X);
      const Vec3 hip = point.position - 1.0 * point.normal;
      const ExactSurface::Point exact = made.exact->nearest(hip);
      const Vec3 want = kStiffness * made.mesh.unit * -exact.distance * exact.normal;
      for (const Method method : kMethods) {
        const Contact contact = nearest_by(cache, method, hip);
        if (!contact.touching) continue;  // beneath the patch, but outside the polygon
        const Vec3 pushed = contact_force(cache, contact, kStiffness), offset = contact.scp - hip;
        const double size = kStiffness * made.mesh.unit * offset.norm();
        EXPECT_NEAR(pushed.norm(), size, 1e-12);
        const Vec3 direction = method == Method::kShaded ? contact.normal : offset;
        EXPECT_LE(oracle::angle<double>(pushed, direction), 1e-9);
        if (method == Method::kGregory) gregory_error.add((pushed - want).norm() / want.norm());
        if (method == Method::kShaded) shaded_angle.add(oracle::angle(pushed, exact.normal));
      }
    }
    EXPECT_LE(gregory_error.value, most);
    EXPECT_LE(shaded_angle.value, 0.035);
    test::record(made.mesh.source, "gregory off by {:.3g} of the force, shaded by {:.3g} rad",
                 gregory_error.value, shaded_angle.value);
  }
}

// HIPs at constant depth beneath a tube, and the exact force at each.
struct Slide {
  std::vector<Vec3> hips, forces;
  void add(const Vec3& hip, double depth, const Vec3& normal) {
    hips.push_back(hip);
    forces.push_back(kStiffness * 1e-3 * depth * normal);
  }
};

// Largest steps: of gregory at most so often that of the exact force, by construction; of the
// others at least so many newtons.
struct Steps {
  // The fair shaded baseline reaches 0.163 N at 2 mm and 0.449 N at 4 mm.
  double gregory, fair, shaded = 0.15, flat = 0.5;
};

void expect_smooth_slide(const std::string& name, const Mesh& mesh, const Slide& slide,
                         const Steps& bound, Construction construction) {
  BuildOptions build;
  build.level.construction = construction;
  const bool is_fair = construction == Construction::kFair;
  const PatchCache cache = build_cache(mesh, build);
  ASSERT_EQ(cache.unit, 1e-3);
  double exact_step = 0;
  for (std::size_t i = 1; i < slide.forces.size(); ++i) {
    exact_step = std::max(exact_step, (slide.forces[i] - slide.forces[i - 1]).norm());
  }
  Worst off;
  TraceOptions options;
  options.stiffness = kStiffness;
  options.settle = 0;
  const auto found = trace(cache, slide.hips, options, [&](std::size_t i, auto steps) {
    off.add((steps[0].force - slide.forces[i]).norm() / slide.forces[i].norm());
  });
  ASSERT_EQ(found.size(), 3u);
  for (const TraceStatistics& s : found) EXPECT_EQ(s.touching, slide.hips.size());
  EXPECT_LE(found[0].largest_step, (is_fair ? bound.fair : bound.gregory) * exact_step);
  EXPECT_GE(found[1].largest_step, bound.shaded);
  EXPECT_GE(found[2].largest_step, bound.flat);
  EXPECT_LE(off.value, is_fair ? 0.01 : 0.02);
  test::record(
      name,
      "{}: largest step exact {:.4f} N, gregory {:.4f} N ({:.3f} x), shaded {:.3f} N, flat "
      "{:.3f} N; gregory within {:.2f} % of exact",
      name_of(kConstructionNames, construction), exact_step, found[0].largest_step,
      found[0].largest_step / exact_step, found[1].largest_step, found[2].largest_step,
      100 * off.value);
}

// Round the tube while going along it: crosses sides of both families.
TEST(Slide, gregory_is_smooth_along_a_generated_knot) {
  const Generated made = torus_knot();
  const double R = 33, r = 17, tube = 12, pi = std::numbers::pi;
  const auto curve = [&](double t) {
    const double ring = R + r * std::cos(3 * t);
    return Vec3(ring * std::cos(2 * t), ring * std::sin(2 * t), r * std::sin(3 * t));
  };
  for (const double depth : {2.0, 4.0}) {
    Slide slide;
    for (int i = 0; i < 20000; ++i) {
      const double t = 2 * pi * i / 20000;
      const Vec3 along = (curve(t + 1e-4) - curve(t - 1e-4)).normalized();
      const Vec3 a = along.cross(Vec3::UnitZ()).normalized(), b = along.cross(a);
      const Vec3 normal = std::cos(7 * t) * a + std::sin(7 * t) * b;
      const Vec3 hip = curve(t) + (tube - depth) * normal;
      const ExactSurface::Point exact = made.exact->nearest(hip);
      slide.add(hip, -exact.distance, exact.normal);
    }
    for (const Construction construction : {Construction::kPaper, Construction::kFair})
      expect_smooth_slide(fmt::format("{} mm", depth), made.mesh, slide,
                          {.gregory = depth < 3 ? 1.6 : 1.9, .fair = 1.2}, construction);
  }
}

class SharedSlide : public test::SharedTest {};

TEST_F(SharedSlide, gregory_is_smooth_along_the_recorded_paths) {
  const Mesh mesh = load_mesh(test::shared_path("knot/knot_1440.obj"), {.unit = 1e-3});
  const std::pair<const char*, Steps> paths[] = {
      {"knot_traj_2mm", {.gregory = 1.6, .fair = 1.15}},
      {"knot_traj_2mm_slow", {.gregory = 1.6, .fair = 1.15}},
      {"knot_traj_4mm", {.gregory = 1.9, .fair = 1.2}}};
  for (const auto& [name, bound] : paths) {
    const InputTable table = read_csv(
        test::shared_path(fmt::format("knot/{}.csv", name)),
        {.alternatives = {{"phase", "x_mm", "y_mm", "z_mm", "depth_mm", "nx", "ny", "nz"}}});
    const auto column = [&](const char* of, std::size_t i) { return (*table.find(of))[i]; };
    Slide slide;
    for (std::size_t i = 0; i < table.rows; ++i) {
      if (column("phase", i) != 1) continue;  // pressing in, or drawing back
      slide.add({column("x_mm", i), column("y_mm", i), column("z_mm", i)}, column("depth_mm", i),
                {column("nx", i), column("ny", i), column("nz", i)});
    }
    ASSERT_EQ(slide.hips.size(), 10000u);
    for (const Construction construction : {Construction::kPaper, Construction::kFair})
      expect_smooth_slide(name, mesh, slide, bound, construction);
  }
}

}  // namespace
}  // namespace gliss
