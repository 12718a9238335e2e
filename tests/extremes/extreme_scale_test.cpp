// Meshes of any size, places far from the origin, and machines that flush denormals.
#include <bit>
#include <cstring>
#include <memory>

#include "gliss/generate/generate.h"
#include "gliss/query/contact_tracker.h"
#include "tests/extremes/extreme_errors.h"
#include "tests/extremes/extreme_polygons.h"

#if defined(__SSE2__)
#include <pmmintrin.h>
#endif

namespace gliss {
namespace {

using oracle::Rng;
using test::hold, test::name_of, test::Polygon, test::Vec2, test::WorstPlace;

// All that a cache answers to one set of questions, as bits; lengths in units of `scale`.
struct Answers {
  std::vector<std::uint64_t> bits;
  bool finite = true;

  void add(double x) {
    finite = finite && std::isfinite(x);
    bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  void add(const Vec3& v) {
    for (const double x : v) add(x);
  }
  void add(const Contact& c, const Vec3& force, double scale) {
    for (const Vec3& v : {Vec3(c.scp / scale), c.normal, Vec3(c.push / scale), Vec3(force / scale)})
      add(v);
    for (const double x : {c.distance / scale, c.residual_angle, c.at.xi, c.at.eta}) add(x);
    for (const std::uint32_t x :
         {c.at.face, c.touching ? 1u : 0u, static_cast<std::uint32_t>(c.iterations),
          static_cast<std::uint32_t>(c.crossings), c.flags})
      bits.push_back(x);
  }
};

Mesh scaled(Mesh mesh, double scale) {
  for (Vec3& p : mesh.positions) p *= scale;
  return mesh;
}

// Points of every face, HIPs beneath and above them, a tracker that follows them all.
Answers ask(const PatchCache& cache, double scale) {
  Rng rng(131);
  Answers all;
  ContactTracker follower(cache, {}), walker(cache, {});
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face) {
    const int n = static_cast<int>(cache.face_valence[face]);
    for (int i = 0; i < 6; ++i) {
      const Vec2 X = i == 0   ? Vec2(Vec2::Zero())
                     : i == 1 ? oracle::domain_corner(n, 1)
                     : i == 2 ? oracle::on_side(n, 0, 0.3)
                              : oracle::random_inside<double>(rng, n);
      const SurfacePoint p = test::at(cache, face, X);
      for (const Vec3& v :
           {Vec3(p.position / scale), Vec3(p.d_xi / scale), Vec3(p.d_eta / scale), p.normal})
        all.add(v);
      const double depth = (i % 2 == 0 ? 0.02 : -0.02) * scale;
      const Vec3 hip = p.position - depth * p.normal;
      for (const Contact& c :
           {nearest(cache, hip), walker.track(hip, {face, 0, 0}), follower.tick(hip)})
        all.add(c, contact_force(cache, c, 1000), scale);
    }
  }
  return all;
}

// Many numbers of sides, a closed mesh, one that folds.
std::vector<Mesh> meshes_to_scale() {
  Rng rng(132);
  std::vector<Mesh> meshes;
  for (const int n : {3, 4, 7, 40, 72, 500})
    meshes.push_back(test::mesh_of(test::sound_polygon(rng, n)));
  meshes.push_back(test::mesh_of(test::tilted(rng, 5, 100 * oracle::kDegree)));
  meshes.push_back(test::with_normals(scaled(goldberg(2).mesh, 0.1)));
  return meshes;
}

template <class Array>
std::size_t differing(const Array& a, const Array& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(a[i])) != 0;
  return count;
}

// Numbers of `b` that are not those of `a` with lengths times `scale`, a power of two.
std::size_t differing(const PatchCache& a, const PatchCache& b, double scale) {
  const auto surfaces = [&]<class Real>(const Surface<Real>& s) {
    const auto& t = std::get<Surface<Real>>(b.surface);
    return differing(s.domain, t.domain) + differing(s.domain_begin, t.domain_begin) +
           differing(s.side_begin, t.side_begin) + differing(s.side_patch, t.side_patch) +
           differing(s.side_twin, t.side_twin) + differing(s.control, t.control) +
           differing(s.control_begin, t.control_begin) + differing(s.form, t.form) +
           differing(s.corner, t.corner) + differing(s.patch, t.patch) +
           differing(s.triangle, t.triangle) + differing(s.node, t.node) +
           differing(s.child, t.child) + differing(s.tile, t.tile) +
           differing(s.tile_begin, t.tile_begin);
  };
  std::size_t count = std::visit(surfaces, a.surface);
  count += differing(a.kind, b.kind) + differing(a.folded, b.folded) +
           differing(a.patch_face, b.patch_face) + differing(a.corner_of_face, b.corner_of_face);
  count += Vec3(scale * a.origin) != b.origin;
  count += a.scale / scale != b.scale;
  constexpr double kFlat = std::numeric_limits<double>::max();
  for (std::size_t p = 0; p < a.rho_min.size(); ++p)
    count += (a.rho_min[p] == kFlat ? kFlat : scale * a.rho_min[p]) != b.rho_min[p];
  return count;
}

TEST(ExtremeScale, of_a_power_of_two_changes_no_bit) {
  const int step = 30 / static_cast<int>(test::samples(1, 30));
  for (const Precision precision : test::kPrecisions) {
    std::uint64_t different = 0, numbers = 0;
    for (const Mesh& mesh : meshes_to_scale()) {
      const PatchCache cache = test::cache_of(mesh, precision);
      const Answers want = ask(cache, 1);
      EXPECT_TRUE(want.finite);
      for (int exponent = -90; exponent <= 90; exponent += step) {
        const double scale = std::ldexp(1.0, exponent);
        const PatchCache other = test::cache_of(scaled(mesh, scale), precision);
        const std::size_t count =
            differing(cache, other, scale) + differing(want.bits, ask(other, scale).bits);
        EXPECT_EQ(count, 0u) << mesh.valence(0) << " sides, 2^" << exponent;
        different += count;
        numbers += want.bits.size();
      }
    }
    hold({"Numbers: sizes and places",
          fmt::format("bits that change with sizes of 2^-90 to 2^90, {}", name_of(precision)), 0},
         static_cast<double>(different), numbers);
  }
}

#if defined(__SSE2__)
// Results and operands that are denormal become zero while it lives.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushDenormals() { _mm_setcsr(before_); }

 private:
  unsigned before_;
};

TEST(ExtremeScale, needs_no_denormals) {
  for (const Precision precision : test::kPrecisions) {
    std::uint64_t different = 0, numbers = 0;
    for (const Mesh& mesh : meshes_to_scale()) {
      for (const int exponent : {-90, 0, 90}) {
        const double scale = std::ldexp(1.0, exponent);
        const Mesh sized = scaled(mesh, scale);
        const PatchCache cache = test::cache_of(sized, precision);
        const Answers want = ask(cache, scale);
        const auto [other, got] = [&] {
          const FlushDenormals flush;
          PatchCache flushed = test::cache_of(sized, precision);
          Answers answers = ask(flushed, scale);
          return std::pair(std::move(flushed), std::move(answers));
        }();
        EXPECT_TRUE(got.finite);
        const std::size_t count = differing(cache, other, 1) + differing(want.bits, got.bits);
        EXPECT_EQ(count, 0u) << mesh.valence(0) << " sides, 2^" << exponent;
        different += count;
        numbers += want.bits.size();
      }
    }
    hold({"Numbers: sizes and places",
          fmt::format("bits that change where denormals are flushed, {}", name_of(precision)), 0},
         static_cast<double>(different), numbers);
  }
}

// Domain points that are denormal, or so near to a corner that shares of a side are.
TEST(ExtremeScale, denormal_points_of_the_domain_are_finite) {
  Rng rng(133);
  std::uint64_t not_finite = 0, points = 0;
  const auto look = [&](const PatchCache& cache, const Vec2& X) {
    const SurfacePoint p = test::at(cache, 0, X);
    ++points;
    not_finite += !(p.position.allFinite() && p.d_xi.allFinite() && p.d_eta.allFinite() &&
                    std::abs(p.normal.norm() - 1) < 1e-12);
  };
  for (const Precision precision : test::kPrecisions) {
    for (const int n : {3, 4, 5, 8, 100}) {
      const PatchCache cache =
          test::cache_of(test::mesh_of(test::sound_polygon(rng, n)), precision);
      for (const bool flushed : {false, true}) {
        const auto flush = flushed ? std::make_unique<FlushDenormals>() : nullptr;
        for (const double tiny : {1e-30, 1e-39, 1e-45, 1e-200, 1e-308, 5e-324}) {
          for (const Vec2& to : {Vec2(tiny, 0), Vec2(0, tiny), Vec2(-tiny, tiny)}) {
            look(cache, to);
            look(cache, oracle::domain_corner(n, 0) + to);
          }
        }
      }
    }
  }
  hold({"Numbers: sizes and places",
        "points not finite where the domain's coordinates are denormal", 0},
       static_cast<double>(not_finite), points);
}
#endif

// A face of 1 mm far away in metres; HIPs made from the oracle, so that their SCPs are known. Its
// corners are rounded to what that place can hold first.
struct Faraway {
  WorstPlace found, tracked;
};

Faraway contacts_at(const Vec3& far, Precision precision) {
  constexpr double kFeature = 1e-3;
  Rng rng(134);
  Faraway result;
  for (std::uint64_t i = 0; i < test::samples(60, 3000); ++i) {
    const int n = 3 + static_cast<int>(rng() % 8);
    Polygon polygon = oracle::with_unit_normals(oracle::random_polygon(rng, n, 0.25));
    for (Vec3& p : polygon.positions) p = kFeature / 2 * p + far;
    Polygon near = polygon;
    for (Vec3& p : near.positions) p -= far;
    const auto exact = oracle::with_unit_normals(oracle::cast<long double>(near));
    const PatchCache cache = test::paper_cache_of(test::mesh_of(polygon), precision);
    ContactTracker tracker(cache, {});
    for (int j = 0; j < 8; ++j) {
      const Vec2 X = 0.9 * oracle::random_inside<double>(rng, n);
      const auto s = oracle::evaluate(exact, X);
      const double depth = oracle::uniform(rng, 1e-6, 1e-5);
      const oracle::Vec<long double> offset = s.G - static_cast<long double>(depth) * s.normal;
      const Vec3 hip = (offset + far.cast<long double>()).cast<double>();
      const auto error = [&](const Contact& c) {
        return static_cast<double>(((c.scp - far).cast<long double>() - s.G).norm());
      };
      const auto where = [&] { return fmt::format("polygon {}, {}", i, test::place_of(n, X)); };
      result.found.add(error(nearest(cache, hip)), where);
      result.tracked.add(error(tracker.track(hip, {0, 0.95 * X.x(), 0.95 * X.y()})), where);
    }
  }
  return result;
}

TEST(ExtremeOffset, contacts_of_features_of_1_mm) {
  for (const Precision precision : test::kPrecisions) {
    // Coordinates of 1e7 are 1.9 nm apart, and the HIP, the SCP and their sum are rounded.
    for (const auto& [offset, goal] : {std::pair{0.0, 2e-9}, {1e6, 2e-9}, {1e7, 4e-9}}) {
      const Faraway got = contacts_at(offset * Vec3(1, -0.7, 0.9), precision);
      const auto row = [&, offset = offset, goal = goal](const char* what,
                                                         const WorstPlace& worst) {
        hold({"Numbers: sizes and places",
              fmt::format("{} SCP at {:g} m, m, {}", what, offset, name_of(precision)), goal,
              precision == Precision::kFloat ? 4 * goal : goal,
              "in float a solver ends at steps of 2^-18 of the patch"},
             worst);
      };
      row("nearest", got.found);
      row("tracked", got.tracked);
    }
  }
}

}  // namespace
}  // namespace gliss
