// Sweeps: the same bytes on any number of threads, every neighbour counted once, figures of a
// sphere.
#include "gliss/sweep/sweep.h"

#include <cstring>

#include "gliss/generate/generate.h"
#include "gliss/surface/names.h"
#include "tests/support/bytes.h"
#include "tests/support/random_meshes.h"
#include "tests/support/sharp_meshes.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

SweepOptions options_of(std::vector<double> depths, std::uint32_t rings) {
  SweepOptions options;
  options.depths = std::move(depths);
  options.rings = rings;
  return options;
}

TEST(Sweep, gives_the_same_bytes_on_any_number_of_threads) {
  const PatchCache cache = test::cache_of(torus_knot(60, 8).mesh);
  const SweepOptions options = options_of({1e-3, 2e-3}, 6);
  const std::string serial = test::swept(cache, *make_serial_engine(), options);
  EXPECT_GT(serial.size(), sample_count(cache, options.rings) * 6 * 9 * sizeof(double));
  for (const int threads : {1, 2, 4}) {
    const std::string parallel = test::swept(cache, *make_tbb_engine(threads), options);
    ASSERT_EQ(parallel.size(), serial.size());
    EXPECT_EQ(std::memcmp(parallel.data(), serial.data(), serial.size()), 0) << threads;
  }
}

// n rings (rings + 1) / 2 points on n sides.
TEST(Sweep, counts_its_samples) {
  // 3 quads, 2 triangles.
  const PatchCache triangles = test::cache_of(test::with_normals(prism(3).mesh));
  EXPECT_EQ(sample_count(triangles, 1), 18u);
  EXPECT_EQ(sample_count(triangles, 4), 180u);
  EXPECT_EQ(rings_for(triangles, 18), 1u);
  EXPECT_EQ(rings_for(triangles, 19), 2u);
  const std::uint32_t rings = rings_for(triangles, 1'000'000);
  EXPECT_GE(sample_count(triangles, rings), 1'000'000u);
  EXPECT_LT(sample_count(triangles, rings - 1), 1'000'000u);
}

TEST(Sweep, meets_every_neighbour_across_an_edge_once) {
  const Mesh mesh = goldberg(3).mesh;
  const PatchCache cache = test::cache_of(mesh);
  for (const std::uint32_t rings : {1u, 2u, 7u}) {
    const SweepResult result = sweep(cache, *make_serial_engine(), options_of({1e-3}, rings));
    ASSERT_EQ(result.statistics.size(), 3u);
    for (const SweepStatistics& s : result.statistics) {
      EXPECT_EQ(s.samples, sample_count(cache, rings));
      EXPECT_EQ(s.edge_step.count(), mesh.corner_vertex.size() / 2 * rings);
      EXPECT_EQ(s.touching, s.samples);
    }
  }
}

// A split triangle's patches are triangles too, with sides within the face.
TEST(Sweep, meets_every_neighbour_of_split_triangles_once) {
  oracle::Rng rng(1);
  std::size_t split = 0;
  for (int i = 0; i < 40; ++i) {
    const Mesh mesh = test::random_sphere(rng, 20, 10, 1.2);
    const PatchCache cache = test::cache_of(mesh);
    split += cache.patch_count() > cache.mesh_face_count;
    SweepOptions options;
    options.depths = {1e-4};
    options.methods = {Method::kFlat};
    options.rings = 2;
    const SweepResult result =
        sweep(cache, *make_serial_engine(), options, [](const SweepBlock&) {});
    EXPECT_EQ(result.statistics[0].edge_step.count(), mesh.corner_vertex.size() / 2 * 2) << i;
  }
  EXPECT_GT(split, 0u);
}

TEST(Sweep, measures_a_sphere) {
  const PatchCache cache = test::cache_of(goldberg(8).mesh);
  const SweepResult result = sweep(cache, *make_serial_engine(), options_of({1e-3}, 8));
  ASSERT_EQ(result.statistics.size(), 3u);
  const SweepStatistics &gregory = result.statistics[0], &shaded = result.statistics[1],
                        &flat = result.statistics[2];
  EXPECT_EQ(gregory.method, Method::kGregory);
  EXPECT_EQ(gregory.depth, 1e-3);
  // The HIP is G - d n, which gregory finds again: k d = 0.5 N.
  EXPECT_LE(gregory.error.max(), 1e-8);
  EXPECT_LE(gregory.residual.max(), 1e-6);
  EXPECT_EQ(gregory.unconverged, 0u);
  EXPECT_LT(gregory.edge_step.max(), flat.edge_step.max() / 2);
  EXPECT_GT(flat.edge_step.max(), 0.05);
  EXPECT_GT(shaded.error.max(), gregory.error.max());
  for (const SweepStatistics& s : result.statistics) {
    test::record(method_name(s.method),
                 "step {:.2g}, across edges {:.2g}, error {:.2g} N, residual {:.2g} rad",
                 s.step.max(), s.edge_step.max(), s.error.max(), s.residual.max());
  }
}

// Chunk by chunk, and in each depth by depth, method by method; faces ascend.
TEST(Sweep, hands_its_blocks_over_in_order) {
  const PatchCache cache = test::cache_of(torus().mesh);
  std::vector<std::array<std::size_t, 3>> order;
  std::uint64_t samples = 0;
  sweep(cache, *make_tbb_engine(2), options_of({1e-4, 2e-4}, 8), [&](const SweepBlock& block) {
    ASSERT_FALSE(block.face.empty());
    order.push_back({block.face.front(), block.depth_index, block.method_index});
    samples += block.face.size();
    EXPECT_TRUE(std::is_sorted(block.face.begin(), block.face.end()));
    EXPECT_EQ(block.hip.size(), block.face.size());
  });
  EXPECT_EQ(samples, 6 * sample_count(cache, 8));
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(Sweep, ends_with_what_progress_throws) {
  struct Stop {};
  const PatchCache cache = test::cache_of(torus_knot().mesh);
  const SweepOptions options = options_of({1e-3}, 8);
  std::uint64_t last = 0, calls = 0;
  const auto stop = [&](std::uint64_t, std::uint64_t) {
    ++calls;
    throw Stop();
  };
  EXPECT_THROW(sweep(cache, *make_tbb_engine(2), options, nullptr, stop), Stop);
  EXPECT_EQ(calls, 1u);
  const auto whole = sweep(cache, *make_serial_engine(), options, nullptr,
                           [&](std::uint64_t done, std::uint64_t total) {
                             EXPECT_GE(done, last);
                             EXPECT_LE(last = done, total);
                           });
  EXPECT_EQ(last, whole.statistics[0].samples);
}

// Few samples lie a bend apart, not a leap; over a sharp edge the nearest point leaps.
TEST(Sweep, tells_leaps_from_bends_between_samples) {
  const auto felt = [](const Mesh& mesh, double depth, std::uint32_t rings) {
    SweepOptions options = options_of({depth}, rings);
    options.methods = {Method::kGregory};
    return sweep(test::cache_of(mesh), *make_serial_engine(), options).statistics[0];
  };
  const SweepStatistics sphere = felt(goldberg(2).mesh, 1e-3, 1);
  EXPECT_GT(sphere.jumps, 0u);
  EXPECT_EQ(sphere.leaps, 0u);
  const SweepStatistics edges = felt(test::with_creases(prism(5).mesh), 3e-3, 24);
  EXPECT_GT(edges.leaps, 100u);
  EXPECT_LE(edges.leaps, edges.jumps);
}

// The pairs of neighbours of a sweep, found anew from its samples of one method and depth.
struct Pairs {
  Histogram step, edge_step;
  std::uint64_t felt = 0, jumps = 0, lost = 0, leaps = 0;
};

Pairs pairs_of(const SweepBlock& all, const std::vector<Vec3>& places, std::uint32_t rings,
               std::uint32_t sides, double full, double stiffness) {
  Pairs pairs;
  const auto add = [&](std::size_t p, std::size_t q, Histogram& step) {
    const double size = (all.force[p] - all.force[q]).norm();
    const bool p_felt = all.force[p] != Vec3::Zero(), q_felt = all.force[q] != Vec3::Zero();
    step.add(size);
    pairs.felt += p_felt || q_felt;
    if (size <= 0.2 * full) return;
    ++pairs.jumps;
    pairs.lost += p_felt != q_felt;
    pairs.leaps += size - 0.2 * full > 2 * stiffness * (all.hip[p] - all.hip[q]).norm();
  };
  const std::size_t points = std::size_t{sides} * rings * (rings + 1) / 2;
  const auto begin_of = [&](std::size_t ring) { return sides * ring * (ring - 1) / 2; };
  std::vector<std::size_t> last;  // samples of the last rings
  for (std::size_t face = 0; face < all.face.size(); face += points) {
    for (std::size_t r = 1; r <= rings; ++r) {
      const std::size_t ring = face + begin_of(r), size = sides * r;
      for (std::size_t i = 0; i < size; ++i) add(ring + i, ring + (i + 1) % size, pairs.step);
      for (std::size_t i = 0; r < rings && i < size; ++i) {
        // Outward in its sector, at the nearest share of the way along the side; of two the later.
        const double share = (static_cast<double>(i % r) + 0.5) / static_cast<double>(r);
        std::size_t nearest = 0;
        for (std::size_t j = 1; j <= r; ++j) {
          const auto off = [&](std::size_t at) {
            return std::abs((static_cast<double>(at) + 0.5) / static_cast<double>(r + 1) - share);
          };
          if (off(j) <= off(nearest) + 1e-12) nearest = j;
        }
        add(ring + i, face + begin_of(r + 1) + i / r * (r + 1) + nearest, pairs.step);
      }
      if (r < rings) continue;
      for (std::size_t i = 0; i < size; ++i) last.push_back(ring + i);
    }
  }
  for (const std::size_t p : last) {
    std::size_t nearest = p;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t q : last) {
      const double distance = (places[p] - places[q]).squaredNorm();
      if (all.face[q] == all.face[p] || !(distance < least)) continue;
      least = distance;
      nearest = q;
    }
    if (p < nearest) add(p, nearest, pairs.edge_step);
  }
  return pairs;
}

// A dodecahedron mirrors each face at its edges. Its faces have more points than a chunk, and deep
// HIPs leave it on the other side.
TEST(Sweep, counts_each_pair_of_neighbours_once) {
  const Mesh mesh = goldberg(1).mesh;
  const PatchCache cache = test::cache_of(test::with_creases(mesh));
  const std::uint32_t rings = 45;
  for (const double depth : {1.0, 14.0, 15.5}) {  // of a radius of 10
    SweepOptions options = options_of({depth * cache.unit}, rings);
    options.methods = {Method::kGregory};
    SweepBlock all;
    const SweepStatistics s =
        sweep(cache, *make_tbb_engine(2), options, [&](const SweepBlock& block) {
          all.face.insert(all.face.end(), block.face.begin(), block.face.end());
          all.hip.insert(all.hip.end(), block.hip.begin(), block.hip.end());
          all.force.insert(all.force.end(), block.force.begin(), block.force.end());
        }).statistics[0];
    const double full = options.stiffness * options.depths[0];
    std::vector<Vec3> places;  // on the flat faces
    for (std::size_t i = 0; i < all.hip.size(); ++i)
      places.push_back(all.hip[i] + depth * newell_normal(mesh, all.face[i]).normalized());
    const Pairs pairs = pairs_of(all, places, rings, 5, full, options.stiffness * cache.unit);
    EXPECT_EQ(s.step.bins(), pairs.step.bins()) << depth;
    EXPECT_EQ(s.edge_step.bins(), pairs.edge_step.bins()) << depth;
    EXPECT_EQ(s.felt_pairs, pairs.felt) << depth;
    EXPECT_EQ(s.jumps, pairs.jumps) << depth;
    EXPECT_EQ(s.lost, pairs.lost) << depth;
    EXPECT_EQ(s.leaps, pairs.leaps) << depth;
    EXPECT_EQ(s.jumps > 0, depth < 15) << depth;
  }
}

// A patch that gives no numbers: all pairs with one of its samples are jumps, and none is small.
TEST(Sweep, never_takes_what_is_not_finite_for_a_small_step) {
  const Mesh mesh = goldberg(3).mesh;
  PatchCache cache = test::cache_of(mesh);
  test::break_patch(cache, 0);
  const std::uint32_t rings = 4, n = mesh.valence(0);
  SweepOptions options = options_of({1e-3}, rings);
  options.methods = {Method::kGregory};
  const SweepStatistics s = sweep(cache, *make_serial_engine(), options).statistics[0];
  const double infinity = std::numeric_limits<double>::infinity();
  const std::uint64_t broken = n * rings * (rings + 1) / 2;  // samples
  EXPECT_EQ(s.error.unsound(), broken);
  EXPECT_GE(s.step.unsound(), broken);
  EXPECT_EQ(s.edge_step.unsound(), std::uint64_t{n} * rings);
  EXPECT_GE(s.jumps, s.step.unsound() + s.edge_step.unsound());
  EXPECT_EQ(s.lost, s.edge_step.unsound());  // of which one alone is broken
  for (const Histogram* of : {&s.step, &s.edge_step, &s.error}) {
    EXPECT_EQ(of->max(), infinity);
    EXPECT_TRUE(std::isfinite(of->mean()));
    EXPECT_TRUE(of->is_consistent());
  }
  EXPECT_LT(s.touching, s.samples);
}

TEST(HistogramTest, merges_to_the_same_in_any_order) {
  Histogram low, high, all;
  for (int i = 1; i <= 1000; ++i) {
    (i % 2 == 0 ? low : high).add(1e-3 * i);
    all.add(1e-3 * i);
  }
  Histogram ab = low, ba = high;
  ab.merge(high);
  ba.merge(low);
  EXPECT_EQ(ab.bins(), ba.bins());
  EXPECT_EQ(ab.bins(), all.bins());
  EXPECT_EQ(all.count(), 1000u);
  EXPECT_EQ(all.max(), 1.0);
  EXPECT_NEAR(all.mean(), 0.5005, 1e-12);
  const double bin = std::pow(10, 1.0 / Histogram::kPerDecade);
  EXPECT_GE(all.quantile(0.5), 0.5 / bin);
  EXPECT_LE(all.quantile(0.5), 0.5 * bin);
  EXPECT_EQ(all.quantile(1), 1.0);
}

// Half of three is the second of them, not the first.
TEST(Histogram, quantiles_are_of_the_rank_that_holds_them) {
  Histogram three;
  for (const double value : {1.0, 10.0, 100.0}) three.add(value);
  EXPECT_NEAR(three.quantile(0.5), 10, 1.3);
  EXPECT_NEAR(three.quantile(0.34), 10, 1.3);
  EXPECT_NEAR(three.quantile(0.33), 1, 0.13);
}

// An edge of a bin would be up to 12 % off.
TEST(Histogram, quantiles_are_no_edges_of_bins) {
  Histogram all;
  for (int i = 1; i <= 100'000; ++i) all.add(1e-5 * i);
  for (const double q : {0.3, 0.5, 0.9, 0.99}) EXPECT_NEAR(all.quantile(q), q, 2e-3 * q);
}

}  // namespace
}  // namespace gliss
