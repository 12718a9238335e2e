// The same bytes for all polygons at the extremes: one point at a time, lanes, every instruction
// set of this machine, and a device that is a processor.
#include <bit>

#include "gliss/build/build_cache.h"
#include "gliss/engine/opencl.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"
#include "tests/extremes/extreme_errors.h"
#include "tests/extremes/extreme_polygons.h"
#include "tests/oracle/union_oracle.h"
#include "tests/support/open_meshes.h"
#include "tests/support/require.h"

namespace gliss {

namespace baseline {
const Kernels<float>& kernels_f32();
const Kernels<double>& kernels_f64();
}  // namespace baseline
#if defined(__x86_64__)
namespace v3 {
const Kernels<float>& kernels_f32();
const Kernels<double>& kernels_f64();
}  // namespace v3
namespace v4 {
const Kernels<float>& kernels_f32();
const Kernels<double>& kernels_f64();
}  // namespace v4
#endif

namespace {

using oracle::Rng;
using test::hold, test::name_of, test::Polygon, test::Vec2;

// Everything of extreme_polygons.h and many sides in one mesh, apart from each other.
Mesh collection() {
  Rng rng(141);
  std::vector<Polygon> polygons;
  for (const int n : {3, 5, 9})
    for (const test::NamedPolygon& p : test::degenerate_normals(rng, n))
      polygons.push_back(p.polygon);
  for (const test::NamedPolygon& p : test::odd_shapes(rng)) polygons.push_back(p.polygon);
  for (const double length : {1e-5, 1e-9, 1e-20})
    for (const test::NamedPolygon& p : test::short_edges(rng, length))
      polygons.push_back(p.polygon);
  for (int tilt = 0; tilt <= 180; tilt += 20)
    polygons.push_back(test::tilted(rng, 3 + tilt / 20, tilt * oracle::kDegree));
  for (const int n : {32, 64, 72, 100, 256, 480, 1000})
    polygons.push_back(test::sound_polygon(rng, n));
  Mesh mesh;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3 place(4.0 * static_cast<double>(i % 16), 4.0 * static_cast<double>(i / 16), 0);
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(polygons[i].size()); ++k) {
      mesh.positions.push_back(polygons[i].positions[k] + place);
      mesh.normals.push_back(polygons[i].normals[k]);
      mesh.corner_vertex.push_back(first + k);
    }
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  }
  mesh.corner_normal = mesh.corner_vertex;
  // And what has borders and neighbours.
  return test::joined({mesh, test::moved(test::open_strip(), {0, -10, 0}),
                       test::moved(test::fan_of_five(), {30, -20, 0}),
                       test::moved(test::half_torus(), {0, -80, 0}),
                       test::moved(test::sheet(1.5), {60, -60, 0}),
                       test::moved(test::lone_triangle(), {0, -20, 0})});
}

struct Questions {
  std::vector<DomainPoint> points, starts;
  std::vector<Vec3> hips;
};

Questions questions_of(const Mesh& mesh) {
  Rng rng(142);
  Questions q;
  const std::size_t stride = 120 / test::samples(1, 4);
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const int n = static_cast<int>(mesh.valence(face));
    const std::vector<Vec2> hard = test::hard_points(rng, n, 4, 1);
    for (std::size_t i = 0; i < hard.size(); ++i) {
      q.points.push_back({face, hard[i].x(), hard[i].y()});
      if (i % stride != face % stride) continue;
      const Polygon polygon = test::polygon_of(mesh, face);
      q.starts.push_back(q.points.back());
      q.hips.push_back(polygon.position(static_cast<int>(i)) +
                       oracle::uniform(rng, 0, 0.5) * oracle::random_unit(rng));
    }
  }
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& odd : {Vec3(std::nan(""), 0, 0), Vec3(0, infinity, 0), Vec3(0, 0, -1e300),
                          Vec3(1e-310, 0, 0), Vec3(1e9, 1e9, 1e9)}) {
    q.hips.push_back(odd);
    q.starts.push_back(q.points[q.hips.size()]);
  }
  return q;
}

// Every number as its bits, NaN as one of them: its sign is a matter of compilers.
using Bits = std::vector<std::uint64_t>;

void add(Bits& bits, double x) {
  bits.push_back(std::isnan(x) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(x));
}
void add(Bits& bits, std::span<const SurfacePoint> points) {
  for (const SurfacePoint& p : points)
    for (const Vec3& v : {p.position, p.d_xi, p.d_eta, p.normal})
      for (const double x : v) add(bits, x);
}
void add(Bits& bits, std::span<const Contact> contacts) {
  for (const Contact& c : contacts) {
    for (const Vec3& v : {c.scp, c.normal, c.push})
      for (const double x : v) add(bits, x);
    for (const double x : {c.distance, c.residual_angle, c.at.xi, c.at.eta}) add(bits, x);
    for (const std::uint32_t x :
         {c.at.face, c.touching ? 1u : 0u, static_cast<std::uint32_t>(c.iterations),
          static_cast<std::uint32_t>(c.crossings), c.flags})
      bits.push_back(x);
  }
}

constexpr Method kGregory[] = {Method::kGregory};

// The answers of an engine.
Bits answers(const ResidentSurface& surface, const Questions& q) {
  std::vector<SurfacePoint> points(q.points.size());
  std::vector<Contact> contacts(q.hips.size());
  Bits bits;
  surface.evaluate(q.points, points);
  add(bits, points);
  surface.nearest(q.hips, kGregory, {}, contacts);
  add(bits, contacts);
  surface.track(q.hips, q.starts, {}, contacts);
  add(bits, contacts);
  return bits;
}

// One point at a time.
Bits answers(const PatchCache& cache, const Questions& q) {
  Bits bits;
  for (const DomainPoint& at : q.points) {
    const SurfacePoint point = evaluate(cache, at);
    add(bits, {&point, 1});
  }
  for (const Vec3& hip : q.hips) {
    const Contact contact = nearest(cache, hip);
    add(bits, {&contact, 1});
  }
  for (std::size_t i = 0; i < q.hips.size(); ++i) {
    ContactTracker tracker(cache, {});
    const Contact contact = tracker.track(q.hips[i], q.starts[i]);
    add(bits, {&contact, 1});
  }
  return bits;
}

// The answers of an instruction set, from the kernels themselves.
template <class Real>
Bits answers(const Kernels<Real>& kernels, const PatchCache& cache, const Questions& q) {
  const auto& s = std::get<Surface<Real>>(cache.surface);
  Bits bits;
  for (const DomainPoint& at : q.points) {
    const PatchPlace place = place_of(cache, s, at);
    const std::uint32_t n = s.valence(place.patch);
    // As many as fill its lanes twice and leave some over.
    const std::size_t count = 2 * static_cast<std::size_t>(kernels.lanes) + 1;
    const std::vector<Real> xi(count, static_cast<Real>(place.xi)),
        eta(count, static_cast<Real>(place.eta));
    std::vector<Real> rows(9 * count);
    kernels.evaluate(&s.domain[s.domain_begin[n]],
                     &s.control[3 * std::size_t{s.control_begin[place.patch]}], s.form[place.patch],
                     n, xi.data(), eta.data(), count, count, rows.data());
    std::vector<SurfacePoint> placed(count);
    place_points<Real>(cache, s, {rows.data(), count, count, &place.patch, 0, 0}, arrays_of(placed),
                       kernels);
    add(bits, {&placed.back(), 1});
  }
  const TrackOptions<Real> options = track_options<Real>(QueryOptions{});
  for (const Vec3& hip : q.hips) {
    RawContact<Real> raw;
    const RawHip<Real> there = raw_hip<Real>(cache, hip);
    kernels.nearest(s, kGregory, 1, options, &there, 1, &raw);
    const Contact contact = contact_of(cache, s, raw);
    add(bits, {&contact, 1});
  }
  for (std::size_t i = 0; i < q.hips.size(); ++i) {
    RawContact<Real> raw;
    const PatchPlace place = place_of(cache, s, q.starts[i]);
    raw.uints[kContactPatch] = place.patch;
    raw.reals[kContactXi] = static_cast<Real>(place.xi);
    raw.reals[kContactEta] = static_cast<Real>(place.eta);
    const RawHip<Real> there = raw_hip<Real>(cache, q.hips[i]);
    kernels.track(s, Method::kGregory, options, &there, 1, &raw);
    const Contact contact = contact_of(cache, s, raw);
    add(bits, {&contact, 1});
  }
  return bits;
}

template <class Real>
std::vector<const Kernels<Real>*> all_kernels() {
  constexpr bool is_float = sizeof(Real) == sizeof(float);
  std::vector<const Kernels<Real>*> all;
  const auto offer = [&](const Kernels<float>& f32, const Kernels<double>& f64) {
    if constexpr (is_float) {
      (void)f64;
      all.push_back(&f32);
    } else {
      (void)f32;
      all.push_back(&f64);
    }
  };
  offer(baseline::kernels_f32(), baseline::kernels_f64());
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    offer(v3::kernels_f32(), v3::kernels_f64());
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    offer(v4::kernels_f32(), v4::kernels_f64());
#endif
  return all;
}

class ExtremeParity : public ::testing::TestWithParam<Precision> {
 protected:
  // The questions, once for each precision.
  struct Asked {
    Mesh mesh = collection();
    PatchCache cache;
    Questions questions = questions_of(mesh);
    Bits want;

    explicit Asked(Precision precision)
        : cache(test::cache_of(mesh, precision)), want(answers(cache, questions)) {}
  };
  static const Asked& asked() {
    if (GetParam() == Precision::kFloat) {
      static const Asked in_float(Precision::kFloat);
      return in_float;
    }
    static const Asked in_double(Precision::kDouble);
    return in_double;
  }

  void compare(const char* name, const Bits& got) { compare(name, got, want_); }
  void compare(const char* name, const Bits& got, const Bits& want) {
    ASSERT_EQ(got.size(), want.size());
    std::uint64_t different = 0;
    for (std::size_t i = 0; i < got.size(); ++i) {
      if (got[i] != want[i] && ++different == 1) fmt::print("    first different: {}\n", i);
    }
    hold({"Numbers: the same bytes",
          fmt::format("numbers that differ from one point at a time: {}, {}", name,
                      name_of(GetParam())),
          0},
         static_cast<double>(different), got.size());
  }

  template <class Real>
  void compare_kernels() {
    for (const Kernels<Real>* k : all_kernels<Real>())
      compare(k->isa, answers(*k, cache_, questions_));
  }

  const Mesh& mesh_ = asked().mesh;
  const PatchCache& cache_ = asked().cache;
  const Questions& questions_ = asked().questions;
  const Bits& want_ = asked().want;
};
INSTANTIATE_TEST_SUITE_P(, ExtremeParity, ::testing::ValuesIn(test::kPrecisions),
                         [](const auto& info) { return name_of(info.param); });

// Every vertex is a point of the surface: nothing nearest may lie beyond it.
TEST_P(ExtremeParity, contacts_are_finite_and_no_farther_than_a_vertex) {
  std::uint64_t not_finite = 0, count = 0;
  test::WorstPlace normal, farther, farther_by_flagged;
  for (const Vec3& hip : questions_.hips) {
    if (!(hip.norm() < 1e6)) continue;
    const Contact c = nearest(cache_, hip);
    const auto where = [&] {
      return fmt::format("HIP ({:.17g}, {:.17g}, {:.17g}), face {}", hip.x(), hip.y(), hip.z(),
                         c.at.face);
    };
    ++count;
    not_finite += !(c.scp.allFinite() && c.normal.allFinite() && c.push.allFinite() &&
                    std::isfinite(c.distance));
    normal.add(std::abs(c.normal.norm() - 1), where);
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& p : mesh_.positions) least = std::min(least, (p - hip).norm());
    const bool is_flagged = cache_.folded[cache_.first_patch(c.at.face)] != 0;
    (is_flagged ? farther_by_flagged : farther)
        .add(std::max(0.0, std::abs(c.distance) - least), where);
  }
  const bool is_float = GetParam() == Precision::kFloat;
  const auto named = [&](const char* what) {
    return fmt::format("contacts with all of these: {}, {}", what, name_of(GetParam()));
  };
  constexpr const char* kGroup = "Numbers: normals and shapes";
  hold({kGroup, named("not finite"), 0}, static_cast<double>(not_finite), count);
  hold({kGroup, named("normal off length 1"), is_float ? 1e-6 : 1e-14}, normal);
  hold({kGroup, named("farther than the nearest vertex, of a face, on a flagged one"),
        is_float ? 1e-5 : 1e-12, 0.01, "an edge of 1e-13 of its face leaves it one direction"},
       farther_by_flagged);
  hold({kGroup, named("farther than the nearest vertex, of a face"), is_float ? 1e-5 : 1e-12},
       farther);
}

TEST_P(ExtremeParity, of_lanes_and_threads) {
  compare("lanes", answers(*make_serial_engine()->reside(cache_), questions_));
  compare("oneTBB", answers(*make_tbb_engine(2)->reside(cache_), questions_));
}

TEST_P(ExtremeParity, of_instruction_sets) {
  if (GetParam() == Precision::kFloat) {
    compare_kernels<float>();
  } else {
    compare_kernels<double>();
  }
}

TEST_P(ExtremeParity, of_a_processor_as_opencl_device) {
  OpenClOptions options;
  options.smallest_batch = 1;
  options.threads = 2;
  try {
    const std::vector<OpenClDevice> devices = opencl_devices();
    const auto pocl = std::find_if(devices.begin(), devices.end(), [](const OpenClDevice& d) {
      return d.platform == "Portable Computing Language" && d.type == "CPU";
    });
    if (pocl == devices.end()) GLISS_SKIP_UNLESS_REQUIRED("no processor is a device");
    options.device = std::to_string(pocl - devices.begin());
  } catch (const DeviceError& e) {
    GLISS_SKIP_UNLESS_REQUIRED(e.what());
  }
  const auto engine = make_opencl_engine(options);
  compare("OpenCL", answers(*engine->reside(cache_), questions_));
  EXPECT_GT(engine->device_seconds(), 0) << "nothing ran on the device";
  // Made on the device too.
  BuildOptions build;
  build.precision = GetParam();
  compare("built with OpenCL", answers(engine->build(mesh_, build), questions_),
          answers(make_serial_engine()->build(mesh_, build), questions_));
}

}  // namespace
}  // namespace gliss
