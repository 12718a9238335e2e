// Batches by arrays: the numbers of one point or HIP at a time, whatever the arrays' type and order
// in memory, and nothing else is written.
#include <gtest/gtest.h>

#include <cstring>
#include <numeric>

#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/surface/names.h"
#include "tests/oracle/oracle.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using oracle::Rng, oracle::uniform;

template <class T>
struct Points {
  std::vector<std::uint32_t> face;
  std::vector<T> xi, eta;

  PointArrays<T> arrays() const { return {face.size(), {face.data()}, {xi.data()}, {eta.data()}}; }
};

// In the order of faces, `many` of each.
template <class T>
Points<T> points_of(const Mesh& mesh, std::size_t many) {
  Rng rng(5);
  Points<T> points;
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face) {
    const int n = static_cast<int>(mesh.valence(face));
    for (std::size_t i = 0; i < many; ++i) {
      const int side = static_cast<int>(rng() % static_cast<std::uint64_t>(n));
      const oracle::Vec2<double> X =
          uniform(rng, 0, 0.99) * oracle::on_side(n, side, uniform(rng, 0, 1));
      points.face.push_back(face);
      points.xi.push_back(static_cast<T>(X.x()));
      points.eta.push_back(static_cast<T>(X.y()));
    }
  }
  return points;
}

template <class T>
Points<T> shuffled(const Points<T>& points) {
  std::vector<std::size_t> order(points.face.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(9));
  Points<T> other;
  for (const std::size_t i : order) {
    other.face.push_back(points.face[i]);
    other.xi.push_back(points.xi[i]);
    other.eta.push_back(points.eta[i]);
  }
  return other;
}

template <class T>
void expect_vector(const StridedVectors<T>& got, std::size_t i, const Vec3& want) {
  for (int c = 0; c < 3; ++c) ASSERT_EQ(got[c][i], static_cast<T>(want[c])) << i << ", axis " << c;
}

// All numbers of a point as rows of a table: 12 columns and one that is nobody's.
template <class T>
struct Rows {
  static constexpr std::size_t kColumns = 13;
  std::vector<T> numbers;

  explicit Rows(std::size_t count) : numbers(kColumns * count, T{-7}) {}
  SurfaceArrays<T> arrays() {
    const auto at = [&](std::size_t column) {
      return strided_vectors(&numbers[column], kColumns * sizeof(T));
    };
    return {.position = at(0), .d_xi = at(3), .d_eta = at(6), .normal = at(9)};
  }
  void expect_last_column_untouched() const {
    for (std::size_t i = kColumns - 1; i < numbers.size(); i += kColumns)
      ASSERT_EQ(numbers[i], T{-7});
  }
};

template <class T>
void expect_points(const PatchCache& cache, const Points<T>& points, const SurfaceArrays<T>& got) {
  for (std::size_t i = 0; i < points.face.size(); ++i) {
    const SurfacePoint want = evaluate(cache, {points.face[i], static_cast<double>(points.xi[i]),
                                               static_cast<double>(points.eta[i])});
    expect_vector(got.position, i, want.position);
    expect_vector(got.d_xi, i, want.d_xi);
    expect_vector(got.d_eta, i, want.d_eta);
    expect_vector(got.normal, i, want.normal);
  }
}

// Crumpled: folded faces are cut into triangles, each a patch.
Mesh with_split_faces() {
  Mesh mesh = goldberg().mesh;
  const double edge =
      (mesh.positions[mesh.corner_vertex[0]] - mesh.positions[mesh.corner_vertex[1]]).norm();
  Rng rng(1);
  for (Vec3& p : mesh.positions) p += 0.3 * edge * oracle::random_unit(rng);
  return test::with_normals(std::move(mesh));
}

class Arrays : public ::testing::TestWithParam<Precision> {
 protected:
  PatchCache cache_of(const Mesh& mesh) const {
    BuildOptions options;
    options.precision = GetParam();
    return build_cache(mesh, options);
  }
  static std::vector<Mesh> meshes() {
    return {torus_knot(24, 5).mesh, goldberg().mesh, with_split_faces()};
  }

  template <class T>
  void expect_evaluates() const;
  template <class T>
  void expect_grids() const;
  template <class T>
  void expect_contacts() const;
};
INSTANTIATE_TEST_SUITE_P(, Arrays, ::testing::Values(Precision::kFloat, Precision::kDouble),
                         [](const auto& info) { return precision_name(info.param); });

template <class T>
void Arrays::expect_evaluates() const {
  bool any_split = false;
  for (const Mesh& mesh : meshes()) {
    const PatchCache cache = cache_of(mesh);
    any_split = any_split || cache.patch_count() > mesh.face_count();
    const auto engine = make_tbb_engine(2);
    const auto surface = engine->reside(cache);
    // By face, shuffled with many points a face, and with but a few.
    for (const std::size_t many : {1, 3, 37}) {
      const Points<T> by_face = points_of<T>(mesh, many);
      for (const Points<T>& points : {by_face, shuffled(by_face)}) {
        Rows<T> rows(points.face.size());
        surface->evaluate(points.arrays(), rows.arrays());
        expect_points(cache, points, rows.arrays());
        rows.expect_last_column_untouched();
      }
    }
  }
  EXPECT_TRUE(any_split);
}
TEST_P(Arrays, of_float_hold_the_points_of_one_at_a_time) { expect_evaluates<float>(); }
TEST_P(Arrays, of_double_hold_the_points_of_one_at_a_time) { expect_evaluates<double>(); }

TEST_P(Arrays, hold_what_is_asked_for_alone) {
  const Mesh mesh = torus_knot(24, 5).mesh;
  const PatchCache cache = cache_of(mesh);
  const Points<float> points = points_of<float>(mesh, 20);
  const std::size_t count = points.face.size();
  Rows<float> all(count);
  const SurfaceArrays<float> every = all.arrays();
  evaluate(cache, points.arrays(), every);
  for (const auto part : {&SurfaceArrays<float>::position, &SurfaceArrays<float>::d_xi,
                          &SurfaceArrays<float>::d_eta, &SurfaceArrays<float>::normal}) {
    std::vector<float> x(count), y(count), z(count);
    SurfaceArrays<float> one;
    one.*part = strided_vectors(x.data(), y.data(), z.data());
    evaluate(cache, points.arrays(), one);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& want = every.*part;
      ASSERT_EQ(x[i], want.x[i]);
      ASSERT_EQ(y[i], want.y[i]);
      ASSERT_EQ(z[i], want.z[i]);
    }
  }
}

template <class T>
void Arrays::expect_grids() const {
  for (const Mesh& mesh : meshes()) {
    const PatchCache cache = cache_of(mesh);
    // More than are evaluated at once, within the domain of any polygon.
    std::vector<T> xi, eta;
    Rng rng(3);
    for (int i = 0; i < 300; ++i) {
      xi.push_back(static_cast<T>(uniform(rng, -0.3, 0.3)));
      eta.push_back(static_cast<T>(uniform(rng, -0.3, 0.3)));
    }
    Points<T> points;
    std::vector<std::uint32_t> faces;
    for (std::uint32_t face = 0; face < mesh.face_count(); face += 3) {
      faces.push_back(face);
      points.face.insert(points.face.end(), xi.size(), face);
      points.xi.insert(points.xi.end(), xi.begin(), xi.end());
      points.eta.insert(points.eta.end(), eta.begin(), eta.end());
    }
    Rows<T> rows(points.face.size());
    make_tbb_engine(2)->reside(cache)->evaluate_grid(faces, std::span<const T>(xi),
                                                     std::span<const T>(eta), rows.arrays());
    expect_points(cache, points, rows.arrays());
  }
}
TEST_P(Arrays, of_float_hold_a_grid_on_each_face) { expect_grids<float>(); }
TEST_P(Arrays, of_double_hold_a_grid_on_each_face) { expect_grids<double>(); }

// All that a caller may ask of a contact, in arrays of its own.
template <class T>
struct Contacts {
  std::unique_ptr<bool[]> touching;
  std::vector<std::uint32_t> face, flags;
  std::vector<T> numbers;
  std::vector<int> counts;
  std::size_t count;

  explicit Contacts(std::size_t n)
      : touching(new bool[n]), face(n), flags(n), numbers(14 * n), counts(2 * n), count(n) {}
  ContactArrays<T> arrays() {
    const auto row = [&](std::size_t r) { return &numbers[r * count]; };
    const auto vectors = [&](std::size_t r) {
      return strided_vectors(row(r), row(r + 1), row(r + 2));
    };
    return {.touching = {touching.get()},
            .face = {face.data()},
            .xi = {row(0)},
            .eta = {row(1)},
            .scp = vectors(2),
            .normal = vectors(5),
            .push = vectors(8),
            .distance = {row(11)},
            .residual_angle = {row(12)},
            .iterations = {counts.data()},
            .crossings = {&counts[count]},
            .flags = {flags.data()},
            .clear = {row(13)}};
  }
  void expect(std::size_t i, const Contact& want) {
    const ContactArrays<T> got = arrays();
    ASSERT_EQ(got.touching[i], want.touching) << i;
    ASSERT_EQ(got.face[i], want.at.face) << i;
    ASSERT_EQ(got.xi[i], static_cast<T>(want.at.xi)) << i;
    ASSERT_EQ(got.eta[i], static_cast<T>(want.at.eta)) << i;
    expect_vector(got.scp, i, want.scp);
    expect_vector(got.normal, i, want.normal);
    expect_vector(got.push, i, want.push);
    ASSERT_EQ(got.distance[i], static_cast<T>(want.distance)) << i;
    ASSERT_EQ(got.residual_angle[i], static_cast<T>(want.residual_angle)) << i;
    ASSERT_EQ(got.iterations[i], want.iterations) << i;
    ASSERT_EQ(got.crossings[i], want.crossings) << i;
    ASSERT_EQ(got.flags[i], want.flags) << i;
    ASSERT_EQ(got.clear[i], static_cast<T>(want.clear)) << i;
  }
};

template <class T>
void Arrays::expect_contacts() const {
  constexpr Method kAsked[] = {Method::kGregory, Method::kFlat};
  for (const Mesh& mesh : meshes()) {
    const PatchCache cache = cache_of(mesh);
    const Points<T> points = points_of<T>(mesh, 4);
    const std::size_t count = points.face.size();
    Rows<T> at(count);
    evaluate(cache, points.arrays(), at.arrays());
    const double depth = 0.005 * test::size_of(mesh);
    std::vector<T> hips(3 * count);
    for (std::size_t i = 0; i < count; ++i) {
      for (int c = 0; c < 3; ++c)
        hips[3 * i + static_cast<std::size_t>(c)] =
            static_cast<T>(static_cast<double>(at.arrays().position[c][i]) -
                           depth * static_cast<double>(at.arrays().normal[c][i]));
    }
    const HipArrays<T> asked{count, strided_vectors<const T>(hips.data())};
    const auto hip = [&](std::size_t i) {
      return Vec3(static_cast<double>(hips[3 * i]), static_cast<double>(hips[3 * i + 1]),
                  static_cast<double>(hips[3 * i + 2]));
    };
    const auto engine = make_tbb_engine(2);
    const auto surface = engine->reside(cache);
    Contacts<T> gregory(count), flat(count), tracked(count);
    QueryOptions flat_options;
    flat_options.method = Method::kFlat;
    surface->nearest(asked, kAsked, {}, std::vector{gregory.arrays(), flat.arrays()});
    surface->track(asked, points.arrays(), {}, tracked.arrays());
    for (std::size_t i = 0; i < count; ++i) {
      gregory.expect(i, nearest(cache, hip(i)));
      flat.expect(i, nearest(cache, hip(i), flat_options));
      const DomainPoint start{points.face[i], static_cast<double>(points.xi[i]),
                              static_cast<double>(points.eta[i])};
      Contact want;
      track(cache, {{hip(i)}}, {{start}}, {}, {&want, 1});
      tracked.expect(i, want);
    }
  }
}
TEST_P(Arrays, of_float_hold_the_contacts_of_one_at_a_time) { expect_contacts<float>(); }
TEST_P(Arrays, of_double_hold_the_contacts_of_one_at_a_time) { expect_contacts<double>(); }

TEST(ArraysMisuse, is_refused) {
  const Mesh mesh = torus_knot(24, 5).mesh;
  const PatchCache cache = build_cache(mesh);
  const auto engine = make_serial_engine();
  const auto surface = engine->reside(cache);
  const std::uint32_t faces[] = {0, 1};
  const double xi[] = {0, 0.1}, eta[] = {0};
  Rows<double> rows(4);
  EXPECT_THROW(surface->evaluate_grid(faces, std::span<const double>(xi),
                                      std::span<const double>(eta), rows.arrays()),
               std::invalid_argument);
  const double hips[6] = {};
  const HipArrays<double> asked{2, strided_vectors<const double>(hips)};
  constexpr Method kAsked[] = {Method::kGregory, Method::kFlat};
  Contacts<double> one(2);
  const ContactArrays<double> out = one.arrays();
  EXPECT_THROW(surface->nearest(asked, kAsked, {}, {&out, 1}), std::invalid_argument);
  const PointArrays<double> start{1, {faces}, {xi}, {eta}};
  EXPECT_THROW(surface->track(asked, start, {}, out), std::invalid_argument);
}

// Nothing is asked, or nothing is asked for.
TEST(ArraysMisuse, of_nothing_do_nothing) {
  const Mesh mesh = torus_knot(24, 5).mesh;
  const PatchCache cache = build_cache(mesh);
  const auto engine = make_serial_engine();
  const auto surface = engine->reside(cache);
  surface->evaluate(PointArrays<float>{}, {});
  surface->evaluate(points_of<double>(mesh, 2).arrays(), {});
  surface->evaluate_grid({}, std::span<const float>{}, {}, {});
  const std::uint32_t faces[] = {0, 1};
  surface->evaluate_grid(faces, std::span<const float>{}, {}, {});
  surface->track(HipArrays<float>{}, {}, {}, {});
  surface->evaluate(std::span<const DomainPoint>{}, {});
  const double hips[6] = {};
  const HipArrays<double> asked{2, strided_vectors<const double>(hips)};
  constexpr Method kAsked[] = {Method::kGregory};
  surface->nearest(asked, kAsked, {}, std::vector<ContactArrays<double>>(1));
}

}  // namespace
}  // namespace gliss
