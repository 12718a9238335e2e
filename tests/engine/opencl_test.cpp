// The OpenCL engine against the host's: the same bits from serial, oneTBB and a device that is a
// CPU, the same figures within a tolerance from others. tests/oclgrind.sh runs the suite
// OpenClSmall again, where every access is checked.
#include "gliss/engine/opencl.h"
#include "gliss/build/build_cache.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <thread>

#include "gliss/generate/generate.h"
#include "gliss/surface/names.h"
#include "tests/engine/opencl_fault.h"
#include "tests/support/bytes.h"
#include "tests/support/open_meshes.h"
#include "tests/support/require.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

// Rings of vertices on a sphere, from the bottom up, each of a divisor of the vertices beneath it;
// a polygon below, triangles to a tip above.
Mesh lantern(const std::vector<std::uint32_t>& rings) {
  Mesh mesh;
  std::vector<std::uint32_t> first;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    first.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    const double tilt = std::numbers::pi *
                        (0.15 + 0.7 * static_cast<double>(i) / static_cast<double>(rings.size()));
    for (std::uint32_t k = 0; k < rings[i]; ++k) {
      const double turn = 2 * std::numbers::pi * k / rings[i];
      mesh.positions.push_back(10 * Vec3(std::sin(tilt) * std::cos(turn),
                                         std::sin(tilt) * std::sin(turn), -std::cos(tilt)));
    }
  }
  const auto tip = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, 10});
  const auto close = [&] {
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corner_vertex.size()));
  };
  for (std::uint32_t k = rings[0]; k-- > 0;) mesh.corner_vertex.push_back(k);
  close();
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    const std::uint32_t each = rings[i] / rings[i + 1];
    for (std::uint32_t k = 0; k < rings[i + 1]; ++k) {
      for (std::uint32_t j = 0; j <= each; ++j)
        mesh.corner_vertex.push_back(first[i] + (k * each + j) % rings[i]);
      mesh.corner_vertex.push_back(first[i + 1] + (k + 1) % rings[i + 1]);
      mesh.corner_vertex.push_back(first[i + 1] + k);
      close();
    }
  }
  for (std::uint32_t k = 0; k < rings.back(); ++k) {
    for (const std::uint32_t vertex :
         {first.back() + k, first.back() + (k + 1) % rings.back(), tip})
      mesh.corner_vertex.push_back(vertex);
    close();
  }
  mesh.unit = 1e-3;
  return test::with_normals(mesh);
}

std::vector<std::uint32_t> faces_of_region() {
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 20; face < 80; face += face % 7 == 0 ? 4 : 1) faces.push_back(face);
  return faces;
}

struct Case {
  const char* name;
  bool shared;
  Mesh (*mesh)();
  std::vector<std::uint32_t> (*faces)() = [] { return std::vector<std::uint32_t>(); };
  const char* level = "exact";
};

Mesh many_valences() { return lantern({24, 24, 8, 4}); }

std::vector<std::uint32_t> all_faces() { return {}; }

const Case kCases[] = {
    {"knot", false, [] { return torus_knot(60, 8).mesh; }},
    {"goldberg", false, [] { return goldberg(3).mesh; }},
    {"lantern", false,
     [] {
       return lantern({40, 40, 8, 8, 4});
     }},
    {"region", false, [] { return torus_knot(24, 6).mesh; }, faces_of_region},
    {"half_torus", false, test::half_torus},
    {"open_fan", false, test::fan_of_five},
    {"ribbon", false, many_valences, all_faces, "ribbon"},
    {"bezier", false, many_valences, all_faces, "bezier"},
    {"table", false, many_valences, all_faces, "table:2"},
    {"fair", false, [] { return irregular(torus(16, 8), 1).mesh; }, all_faces, "fair"},
    {"fair_mixed", false, many_valences, all_faces, "fair-table:2"},
    {"teeth", true, [] { return test::load_shared("meshes/teeth32_ngon"); }},
    {"spot", true, [] { return test::load_shared("meshes/spot_control"); }}};

BuildOptions options_of(const Case& c, Precision precision) {
  BuildOptions options;
  options.precision = precision;
  options.faces = c.faces();
  options.level = find_surface(c.level).value();
  return options;
}

// Questions to a cache: points all over the domain and on its border, HIPs near and far, and some
// that are no numbers.
struct Questions {
  std::vector<DomainPoint> points, starts;
  std::vector<Vec3> hips;
  double size = 0;
};

// `near`: only HIPs of a short search.
Questions questions_of(const PatchCache& cache, std::size_t count, bool near = false) {
  Rng rng(7);
  Questions q;
  std::vector<std::uint32_t> faces;
  for (std::uint32_t face = 0; face < cache.mesh_face_count; ++face)
    if (cache.first_patch(face) != kNone) faces.push_back(face);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t face = faces[i < faces.size() ? i : rng() % faces.size()];
    const int n = static_cast<int>(cache.face_valence[face]), k = static_cast<int>(rng() % 97) % n;
    const test::Vec2 at = i % 16 == 0   ? test::Vec2(0, 0)
                          : i % 16 == 1 ? oracle::domain_corner<double>(n, k)
                          : i % 16 == 2 ? oracle::on_side<double>(n, k, uniform(rng, 0, 1))
                                        : oracle::random_inside<double>(rng, n);
    q.points.push_back({face, at.x(), at.y()});
  }
  std::vector<SurfacePoint> on(count);
  evaluate(cache, q.points, on);
  const Box box = cache.bounds();
  q.size = (box.high - box.low).norm();
  for (std::size_t i = 0; i < count; ++i) {
    const double depth = i % 4 == 0 ? 0 : uniform(rng, -0.05, 0.02) * (near ? 0.1 : 1) * q.size;
    Vec3 hip = on[i].position + depth * on[i].normal;
    if (!near && i % 8 == 3)
      for (int axis = 0; axis < 3; ++axis)
        hip[axis] = uniform(rng, -1, 1) * (i % 16 == 3 ? 10 : 0.6) * q.size;
    q.hips.push_back(hip);
    q.starts.push_back(q.points[i % 5 == 0 ? rng() % count : i]);
  }
  if (near) return q;
  const double infinity = std::numeric_limits<double>::infinity();
  const Vec3 odd[] = {{std::nan(""), 0, 0}, {0, infinity, 0}, {0, 0, -1e300}, {1e-310, 0, 0}};
  for (std::size_t i = 0; i < std::size(odd); ++i) q.hips[i * 11 % count] = odd[i];
  return q;
}

// Answers as rows of numbers, of which the leading `judged` are compared where bits may differ.
struct Answers {
  std::size_t row = 1, judged = 1;
  std::vector<double> numbers;
};

Answers answers_of(std::span<const SurfacePoint> points) {
  Answers a{12, 12, {}};
  for (const SurfacePoint& p : points)
    for (const Vec3& v : {p.position, p.d_xi, p.d_eta, p.normal})
      a.numbers.insert(a.numbers.end(), v.begin(), v.end());
  return a;
}

Answers answers_of(std::span<const Contact> contacts) {
  Answers a{18, 1, {}};
  for (const Contact& c : contacts) {
    a.numbers.push_back(c.distance);
    for (const Vec3& v : {c.scp, c.normal, c.push})
      a.numbers.insert(a.numbers.end(), v.begin(), v.end());
    for (const double x : {c.residual_angle, c.at.xi, c.at.eta}) a.numbers.push_back(x);
    for (const std::uint32_t x :
         {c.at.face, c.touching ? 1u : 0u, static_cast<std::uint32_t>(c.iterations),
          static_cast<std::uint32_t>(c.crossings), c.flags})
      a.numbers.push_back(x);
  }
  return a;
}

Answers evaluated(const ResidentSurface& surface, const Questions& q) {
  std::vector<SurfacePoint> out(q.points.size());
  surface.evaluate(q.points, out);
  return answers_of(out);
}

constexpr Method kAll[] = {Method::kGregory, Method::kShaded, Method::kFlat};

// By arrays of float, one of which holds the rows of a table; then on a grid.
Answers evaluated_by_arrays(const ResidentSurface& surface, const Questions& q) {
  std::vector<std::uint32_t> face;
  std::vector<float> xi, eta;
  for (const DomainPoint& p : q.points) {
    face.push_back(p.face);
    xi.push_back(static_cast<float>(p.xi));
    eta.push_back(static_cast<float>(p.eta));
  }
  constexpr float kGrid[] = {-0.2f, 0, 0.3f, 0.1f, 0.25f};
  const std::size_t count = face.size(), both = count + count * std::size(kGrid);
  std::vector<float> rows(12 * both);
  const auto at = [&](std::size_t row) {
    const auto vectors = [&](std::size_t column) {
      return strided_vectors(&rows[12 * row + column], 12 * sizeof(float));
    };
    return SurfaceArrays<float>{vectors(0), vectors(3), vectors(6), vectors(9)};
  };
  surface.evaluate({count, {face.data()}, {xi.data()}, {eta.data()}}, at(0));
  surface.evaluate_grid(face, std::span<const float>(kGrid), std::span<const float>(kGrid),
                        at(count));
  return {12, 12, {rows.begin(), rows.end()}};
}

Answers nearest_by_arrays(const ResidentSurface& surface, const Questions& q) {
  std::vector<float> hips;
  for (const Vec3& hip : q.hips) {
    for (const double x : hip) hips.push_back(static_cast<float>(x));
  }
  const std::size_t count = q.hips.size();
  std::vector<float> rows(14 * count);
  std::vector<ContactArrays<float>> out;
  for (const std::size_t first : {0, 7}) {
    const auto vectors = [&](std::size_t column) {
      return strided_vectors(&rows[first + column], 14 * sizeof(float));
    };
    out.push_back(
        {.scp = vectors(1), .push = vectors(4), .distance = {&rows[first], 14 * sizeof(float)}});
  }
  surface.nearest(HipArrays<float>{count, strided_vectors<const float>(hips.data())},
                  std::span(kAll).first(2), {}, out);
  return {7, 1, {rows.begin(), rows.end()}};
}

constexpr Solver kSolvers[] = {Solver::kNewton, Solver::kGaussNewton, Solver::kPaper};

Answers nearest_of(const ResidentSurface& surface, const Questions& q, Solver solver,
                   std::span<const Method> methods = kAll) {
  QueryOptions options;
  options.solver = solver;
  std::vector<Contact> out(methods.size() * q.hips.size());
  surface.nearest(q.hips, methods, options, out);
  return answers_of(out);
}

Answers tracked(const ResidentSurface& surface, const Questions& q, Method method, Solver solver) {
  QueryOptions options;
  options.method = method;
  options.solver = solver;
  std::vector<Contact> out(q.hips.size());
  surface.track(q.hips, q.starts, options, out);
  return answers_of(out);
}

// Compares, and keeps count.
class Judge {
 public:
  Judge(bool exact, Precision precision, double size)
      : exact_(exact), tolerance_(precision == Precision::kDouble ? 1e-12 : 2e-5), size_(size) {}

  void compare(const Answers& want, const Answers& got) {
    ASSERT_EQ(want.numbers.size(), got.numbers.size());
    for (std::size_t first = 0; first < want.numbers.size(); first += want.row) {
      ++rows_;
      bool same = true;
      for (std::size_t i = first; i < first + want.row; ++i) {
        const double a = want.numbers[i], b = got.numbers[i];
        const bool nan = std::isnan(a) && std::isnan(b);
        same = same && std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
        if (i - first < want.judged && !nan && a != b)
          worst_.add(std::abs(a - b) / std::max(size_, std::abs(a)));
      }
      if (!same && first_different_.empty())
        first_different_ = fmt::format("row {}", first / want.row);
      identical_ += same;
    }
  }

  void conclude(const std::string& name) const {
    EXPECT_GT(rows_, 0u);
    if (exact_) {
      EXPECT_EQ(identical_, rows_) << "first different: " << first_different_;
    }
    EXPECT_LE(worst_.value, tolerance_);
    test::record(name, "{} of {} bit-identical, worst {:.2g} of size", identical_, rows_,
                 worst_.value);
  }

 private:
  bool exact_;
  double tolerance_, size_;
  std::size_t rows_ = 0, identical_ = 0;
  test::Worst worst_;
  std::string first_different_;
};

// Skips where there is no device. What is asked of it is done on it, however small.
class OpenClTest : public ::testing::Test {
 protected:
  void SetUp() override {
    test::pretend_nothing();
    test::fail_call(nullptr);
    try {
      opencl_devices();
    } catch (const DeviceError& e) {
      GLISS_SKIP_UNLESS_REQUIRED(e.what());
    }
  }
  void TearDown() override { test::pretend_nothing(); }

  static OpenClOptions all_on_device() {
    OpenClOptions options;
    options.smallest_batch = 1;
    options.threads = 2;
    return options;
  }
  static std::unique_ptr<Engine> engine(const OpenClOptions& options = all_on_device()) {
    return make_opencl_engine(options);
  }
  // The device that engines are made on: the first GPU, else the first.
  static OpenClDevice device() {
    const std::vector<OpenClDevice> all = opencl_devices();
    for (const OpenClDevice& d : all)
      if (d.type == "GPU") return d;
    return all.front();
  }
  // PoCL computes as the host does, bit by bit.
  static bool exact() { return device().platform == "Portable Computing Language"; }
  static bool can(Precision precision) { return precision == Precision::kFloat || device().fp64; }
};

struct Asked {
  Case cache;
  Precision precision;
};

std::vector<Asked> all_asked() {
  std::vector<Asked> all;
  for (const Case& c : kCases)
    for (const Precision p : {Precision::kDouble, Precision::kFloat}) all.push_back({c, p});
  return all;
}

using OpenCl = OpenClTest;

class OpenClParity : public OpenClTest, public ::testing::WithParamInterface<Asked> {
 protected:
  void SetUp() override {
    OpenClTest::SetUp();
    if (IsSkipped()) return;
    const auto& [kind, precision] = GetParam();
    if (kind.shared && !std::filesystem::exists(test::shared_path("meshes")))
      GTEST_SKIP() << "skipped: ../shared is absent";
    if (!can(precision)) GTEST_SKIP() << "skipped: " << device().name << " has no fp64";
    cache_ = build_cache(kind.mesh(), options_of(kind, precision));
    cache_.winding = nullptr;  // where there is one, the host answers for the device
    questions_ = questions_of(cache_, 1500);
    few_ = questions_of(cache_, 400);
  }

  // Expects that ask(surface) says on every engine what it says on one thread.
  template <class Ask>
  void expect_parity(const std::string& name, Ask ask) const {
    Judge host(true, GetParam().precision, questions_.size),
        device(exact(), GetParam().precision, questions_.size);
    const auto serial = make_serial_engine();
    const std::vector<Answers> want = ask(*serial->reside(cache_));
    for (const int threads : {1, 2, 4}) {
      const auto tbb = make_tbb_engine(threads);
      const std::vector<Answers> got = ask(*tbb->reside(cache_));
      for (std::size_t i = 0; i < want.size(); ++i) host.compare(want[i], got[i]);
    }
    const auto opencl = engine();
    const std::vector<Answers> got = ask(*opencl->reside(cache_));
    for (std::size_t i = 0; i < want.size(); ++i) device.compare(want[i], got[i]);
    EXPECT_GT(opencl->device_seconds(), 0) << "nothing ran on the device";
    host.conclude(name + " on oneTBB");
    device.conclude(name + " on the device");
  }

  PatchCache cache_;
  Questions questions_, few_;  // few_: for searches
};

TEST_P(OpenClParity, builds) {
  if (!exact()) GTEST_SKIP() << "skipped: " << device().name << " is not exact";
  const auto& [kind, precision] = GetParam();
  const Mesh mesh = kind.mesh();
  const BuildOptions options = options_of(kind, precision);
  const std::string want = test::bytes_of(cache_);
  for (const int threads : {1, 2, 4}) {
    const PatchCache cache = make_tbb_engine(threads)->build(mesh, options);
    EXPECT_TRUE(test::bytes_of(cache) == want) << threads;
  }
  const auto opencl = engine();
  EXPECT_TRUE(test::bytes_of(opencl->build(mesh, options)) == want);
  EXPECT_GT(opencl->device_seconds(), 0) << "nothing ran on the device";
}

TEST_P(OpenClParity, evaluates) {
  expect_parity("evaluate", [&](const ResidentSurface& surface) {
    return std::vector{evaluated(surface, questions_)};
  });
}

TEST_P(OpenClParity, finds_the_nearest) {
  expect_parity("nearest", [&](const ResidentSurface& surface) {
    std::vector<Answers> all;
    for (const Solver solver : kSolvers) all.push_back(nearest_of(surface, few_, solver));
    for (const Method& method : kAll)
      all.push_back(nearest_of(surface, few_, Solver::kNewton, {&method, 1}));
    return all;
  });
}

TEST_P(OpenClParity, tracks) {
  expect_parity("track", [&](const ResidentSurface& surface) {
    std::vector<Answers> all;
    for (const Solver solver : kSolvers)
      for (const Method method : kAll) all.push_back(tracked(surface, questions_, method, solver));
    return all;
  });
}

TEST_P(OpenClParity, sweeps) {
  if (!exact()) GTEST_SKIP() << "skipped: " << device().name << " is not exact";
  SweepOptions options;
  options.depths = {0.002 * questions_.size * cache_.unit, 0.01 * questions_.size * cache_.unit};
  options.rings = cache_.patch_count() > 1000 ? 1 : 2;
  const std::string want = test::swept(cache_, *make_serial_engine(), options);
  ASSERT_GT(want.size(), 100 * sample_count(cache_, options.rings));
  for (const int threads : {1, 2, 4})
    EXPECT_TRUE(test::swept(cache_, *make_tbb_engine(threads), options) == want) << threads;
  const auto opencl = engine();
  EXPECT_TRUE(test::swept(cache_, *opencl, options) == want);
  EXPECT_GT(opencl->device_seconds(), 0) << "nothing ran on the device";
}

INSTANTIATE_TEST_SUITE_P(Surfaces, OpenClParity, ::testing::ValuesIn(all_asked()),
                         [](const auto& info) {
                           return std::string(info.param.cache.name) +
                                  (info.param.precision == Precision::kFloat ? "_float"
                                                                             : "_double");
                         });

// The shared meshes are there for patches that are not exact.
TEST(OpenClCases, hold_every_kind_of_patch_and_many_valences) {
  const PatchCache cache = test::cache_of(lantern({40, 40, 8, 8, 4}));
  EXPECT_EQ(std::set<std::uint32_t>(cache.face_valence.begin(), cache.face_valence.end()),
            (std::set<std::uint32_t>{3, 4, 5, 8, 40}));
  if (!std::filesystem::exists(test::shared_path("meshes")))
    GTEST_SKIP() << "skipped: ../shared is absent";
  std::set<PatchKind> kinds;
  for (const Case& c : kCases) {
    const auto kind = build_cache(c.mesh(), options_of(c, Precision::kDouble)).kind;
    kinds.insert(kind.begin(), kind.end());
  }
  EXPECT_EQ(kinds.size(), 4u);
}

// Every call of a small surface: by any width of vectors, whether memory is shared or copied, in
// as many pieces as its memory makes of it. 21 faces of 24, 6, 5, 4 and 3 sides.
class OpenClSmall : public OpenClTest, public ::testing::WithParamInterface<Precision> {
 protected:
  void SetUp() override {
    OpenClTest::SetUp();
    if (IsSkipped()) return;
    if (!can(GetParam())) GTEST_SKIP() << "skipped: " << device().name << " has no fp64";
    cache_ = test::cache_of(lantern({24, 8, 4, 4}), GetParam());
    // A whole group of work-items and a part of one; under Oclgrind, which is slow, less.
    const char* count = std::getenv("GLISS_TEST_QUESTIONS");
    slow_ = count != nullptr;
    questions_ = questions_of(cache_, count == nullptr ? 70 : std::stoul(count), slow_);
    host_ = serial_->reside(cache_);
  }

  Judge judge() const { return Judge(exact(), GetParam(), questions_.size); }

  bool slow_ = false;
  const std::unique_ptr<Engine> serial_ = make_serial_engine();
  PatchCache cache_;
  Questions questions_;
  std::unique_ptr<ResidentSurface> host_;
};

TEST_P(OpenClSmall, evaluates_with_any_number_of_lanes) {
  Judge judge = this->judge();
  const bool single = GetParam() == Precision::kFloat;
  for (const char* level : {"exact", "ribbon", "bezier", "table:2", "fair"}) {
    BuildOptions options;
    options.precision = GetParam();
    options.level = find_surface(level).value();
    const PatchCache cache = build_cache(lantern({24, 8, 4, 4}), options);
    const Answers want = evaluated(*serial_->reside(cache), questions_);
    for (const int lanes : {1, 4, 8, 16}) {
      // No device has 16 in double; to compile them takes as long as all others.
      if (!single && lanes == 16 && options.level != Level{}) continue;
      test::pretend(
          single ? CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT : CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE,
          static_cast<cl_ulong>(lanes));
      ASSERT_EQ(single ? device().lanes_float : device().lanes_double, lanes);
      const auto opencl = engine();
      judge.compare(want, evaluated(*opencl->reside(cache), questions_));
      EXPECT_GT(opencl->device_seconds(), 0);
    }
  }
  judge.conclude("evaluate");
}

TEST_P(OpenClSmall, takes_and_gives_arrays) {
  Judge judge = this->judge();
  const auto opencl = engine();
  const auto there = opencl->reside(cache_);
  judge.compare(evaluated_by_arrays(*host_, questions_), evaluated_by_arrays(*there, questions_));
  judge.compare(nearest_by_arrays(*host_, questions_), nearest_by_arrays(*there, questions_));
  EXPECT_GT(opencl->device_seconds(), 0);
  judge.conclude("arrays");
}

// Builds with any number of lanes; under Oclgrind with those of one kind of device.
TEST_P(OpenClSmall, builds) {
  if (!device().fp64) GTEST_SKIP() << "skipped: " << device().name << " has no fp64";
  const Mesh mesh = slow_ ? lantern({4}) : lantern({24, 8, 4, 4});
  BuildOptions options;
  options.precision = GetParam();
  options.level.construction = Construction::kPaper;  // by both kernels
  const PatchCache want = build_cache(mesh, options);
  for (const int lanes : {1, 4, 8, 16}) {
    if (slow_ && lanes != 4) continue;
    test::pretend(CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE, static_cast<cl_ulong>(lanes));
    const auto opencl = engine();
    const PatchCache got = opencl->build(mesh, options);
    EXPECT_GT(opencl->device_seconds(), 0);
    if (exact()) {
      EXPECT_TRUE(test::bytes_of(got) == test::bytes_of(want)) << lanes << " lanes";
    }
    const Questions questions = questions_of(want, 70, true);
    const auto serial = make_serial_engine();
    Judge judge(exact(), GetParam(), questions.size);
    judge.compare(evaluated(*serial->reside(want), questions),
                  evaluated(*serial->reside(got), questions));
    judge.conclude(fmt::format("build, {} lanes", lanes));
  }
}

TEST_P(OpenClSmall, finds_the_nearest) {
  Judge judge = this->judge();
  const auto opencl = engine();
  const auto there = opencl->reside(cache_);
  for (const Solver solver : kSolvers)
    if (solver == Solver::kNewton || !slow_)
      judge.compare(nearest_of(*host_, questions_, solver), nearest_of(*there, questions_, solver));
  for (const Method& method : kAll) {
    if (slow_) break;
    judge.compare(nearest_of(*host_, questions_, Solver::kNewton, {&method, 1}),
                  nearest_of(*there, questions_, Solver::kNewton, {&method, 1}));
  }
  EXPECT_GT(opencl->device_seconds(), 0);
  judge.conclude("nearest");
}

TEST_P(OpenClSmall, tracks) {
  Judge judge = this->judge();
  const auto opencl = engine();
  const auto there = opencl->reside(cache_);
  for (const Solver solver : kSolvers)
    for (const Method method : kAll)
      judge.compare(tracked(*host_, questions_, method, solver),
                    tracked(*there, questions_, method, solver));
  EXPECT_GT(opencl->device_seconds(), 0);
  judge.conclude("track");
}

// Room for the patches and for two pieces of a group of work-items, the least that a device takes.
TEST_P(OpenClSmall, cuts_what_its_memory_does_not_hold) {
  Judge judge = this->judge();
  const Questions many = questions_of(cache_, 300);
  for (const cl_ulong shared : {1, 0}) {
    test::pretend(CL_DEVICE_HOST_UNIFIED_MEMORY, shared);
    OpenClOptions options = all_on_device();
    const bool single = GetParam() == Precision::kFloat;
    const int lanes = single ? device().lanes_float : device().lanes_double;
    options.memory =
        test::surface_bytes(cache_) +
        2 * 64 * 11 * (single ? 4 : 8) * static_cast<std::uint64_t>(std::max(lanes, 8));
    const auto opencl = engine(options);
    const auto there = opencl->reside(cache_);
    judge.compare(evaluated(*host_, many), evaluated(*there, many));
    judge.compare(nearest_of(*host_, many, Solver::kNewton),
                  nearest_of(*there, many, Solver::kNewton));
    judge.compare(tracked(*host_, many, Method::kGregory, Solver::kNewton),
                  tracked(*there, many, Method::kGregory, Solver::kNewton));
  }
  judge.conclude("pieces");
}

INSTANTIATE_TEST_SUITE_P(Precisions, OpenClSmall,
                         ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

TEST_F(OpenCl, leaves_small_batches_to_the_host) {
  const PatchCache cache = test::cache_of(lantern({24, 8, 4, 4}), Precision::kFloat);
  OpenClOptions options = all_on_device();
  options.smallest_batch = 50;
  const auto opencl = engine(options);
  const auto there = opencl->reside(cache);
  nearest_of(*there, questions_of(cache, 49), Solver::kNewton);
  EXPECT_EQ(opencl->device_seconds(), 0);
  nearest_of(*there, questions_of(cache, 50), Solver::kNewton);
  EXPECT_GT(opencl->device_seconds(), 0);
}

// Fair patches and those beside creases come to the device drafted, alone and among patches that it
// builds, whether memory is shared or copied.
TEST_F(OpenCl, builds_drafted_patches_as_the_host_does) {
  if (!exact()) GTEST_SKIP() << "skipped: " << device().name << " is not exact";
  Mesh rim = prism(5).mesh;
  rim.normals.clear(), rim.corner_normal.clear();
  const Mesh meshes[] = {irregular(torus(16, 8), 1).mesh,
                         torus_knot(24, 6).mesh,
                         lantern({24, 8, 4, 4}),
                         test::half_torus(),
                         test::in_triangles(test::half_torus()),
                         test::with_creases(test::l_solid()),
                         test::with_creases(rim),
                         fin().mesh};
  for (const cl_ulong shared : {1, 0}) {
    test::pretend(CL_DEVICE_HOST_UNIFIED_MEMORY, shared);
    const auto opencl = engine();
    for (const Mesh& mesh : meshes) {
      for (const Precision precision : {Precision::kDouble, Precision::kFloat}) {
        const double before = opencl->device_seconds();
        BuildOptions options;
        options.precision = precision;
        BuildReport want, got;
        const std::string bytes = test::bytes_of(build_cache(mesh, options, &want));
        EXPECT_TRUE(test::bytes_of(opencl->build(mesh, options, &got)) == bytes) << mesh.source;
        EXPECT_EQ(got.flagged_faces, want.flagged_faces) << mesh.source;
        EXPECT_GT(opencl->device_seconds(), before) << mesh.source << ": nothing on the device";
      }
    }
  }
}

TEST_F(OpenCl, answers_several_threads_at_once) {
  const PatchCache cache = test::cache_of(goldberg(2).mesh, Precision::kFloat);
  const auto serial = make_serial_engine(), opencl = engine();
  const auto here = serial->reside(cache), there = opencl->reside(cache);
  const std::size_t counts[] = {700, 901, 1103, 1307};
  std::vector<Questions> questions;
  std::vector<Answers> points(4), contacts(4);
  for (const std::size_t count : counts) questions.push_back(questions_of(cache, count));
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (int again = 0; again < 5; ++again) {
        points[t] = evaluated(*there, questions[t]);
        contacts[t] = nearest_of(*there, questions[t], Solver::kNewton);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  Judge judge(exact(), Precision::kFloat, questions[0].size);
  for (std::size_t t = 0; t < 4; ++t) {
    judge.compare(evaluated(*here, questions[t]), points[t]);
    judge.compare(nearest_of(*here, questions[t], Solver::kNewton), contacts[t]);
  }
  judge.conclude("4 threads");
}

}  // namespace
}  // namespace gliss
