// Nearest points: cold, warm, and tick by tick.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <random>

#include "bench/benches.h"
#include "bench/meshes.h"
#include "bench/peers/peers.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/frames.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/names.h"
#include "gliss/surface/winding.h"
#include "gliss/walk/walk.h"

namespace gliss::bench {
namespace {

constexpr std::size_t kHips = 4096, kTracked = 8 * kHips;
constexpr double kOffset = 0.02, kMove = 0.001;  // of the mesh's size
constexpr double kGoodEnough = 1e-6;             // ... as an error of a tracked contact

// HIPs beneath the surface, in the order of faces, with the points that they lie beneath.
struct Hips {
  std::vector<DomainPoint> points;
  std::vector<Vec3> hips;
};

Hips hips_beneath(const PatchCache& cache, std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.4, 0.4);
  Hips h;
  for (std::size_t i = 0; i < count; ++i) {
    const auto face = static_cast<std::uint32_t>(i * cache.mesh_face_count / count);
    const double xi = uniform(random), eta = uniform(random);
    h.points.push_back({face, xi, eta});
  }
  std::vector<SurfacePoint> at(count);
  evaluate(cache, h.points, at);
  const double offset = kOffset * size_of(cache);
  for (const SurfacePoint& p : at) h.hips.push_back(p.position - offset * p.normal);
  return h;
}

std::vector<Vec3> shuffled(std::vector<Vec3> hips) {
  std::shuffle(hips.begin(), hips.end(), std::mt19937(2));
  return hips;
}

enum class Search { kRandom, kSpatial };

std::vector<Vec3> hips_of(Search order) {
  // The same whatever is asked for them.
  std::vector<Vec3> hips = hips_beneath(cache_of(Shape::kKnot, Precision::kDouble), kHips).hips;
  return order == Search::kRandom ? shuffled(std::move(hips)) : hips;
}

double quantile(const std::vector<double>& sorted, double q) {
  const auto at = static_cast<std::size_t>(q * static_cast<double>(sorted.size()));
  return sorted[std::min(sorted.size() - 1, at)];
}

double iterations_of(const std::vector<Contact>& contacts) {
  double sum = 0;
  for (const Contact& c : contacts) sum += c.iterations;
  return sum / static_cast<double>(contacts.size());
}

Work make_nearest(const QueryOptions& options, Precision precision, Search order, int threads) {
  std::shared_ptr<ResidentSurface> surface =
      engine_of(threads).reside(cache_of(Shape::kKnot, precision));
  std::vector<Contact> contacts(kHips);
  const auto hips = hips_of(order);
  surface->project(hips, options, contacts);
  Work work{static_cast<double>(kHips), nullptr};
  work.counters["solver_iterations"] = iterations_of(contacts);
  work.run = [=]() mutable { surface->project(hips, options, contacts); };
  return work;
}

// A quarter of what is good enough, for what a solver leaves is up to three times its tolerance;
// relative to the patches' size.
double patch_tolerance(const PatchCache& cache) {
  double most = 0;
  std::visit(
      [&](const auto& s) {
        for (std::uint32_t p = 0; p < s.patch_count(); ++p)
          most = std::max(most, static_cast<double>(s.patch[p * kPatchReals + kPatchUnscale]));
      },
      cache.surface);
  return 0.25 * kGoodEnough * size_of(cache) * cache.scale / most;
}

// HIPs that moved since they lay beneath their points.
Hips moved_hips(const PatchCache& cache) {
  Hips h = hips_beneath(cache, kTracked);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const double move = kMove * size_of(cache);
  for (Vec3& hip : h.hips) {
    const Vec3 way(normal(random), normal(random), normal(random));
    hip += move * way.normalized();
  }
  return h;
}

// HIPs as the kernels take them.
template <class Real>
std::vector<RawHip<Real>> raw_hips(const PatchCache& cache, const std::vector<Vec3>& hips) {
  std::vector<RawHip<Real>> raw;
  for (const Vec3& hip : hips) raw.push_back(raw_hip<Real>(cache, hip));
  return raw;
}

Work kernel_nearest(Precision precision, Search order) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision);
  return with_surface(cache, [&]<class Real>(const Surface<Real>& s) -> Work {
    const auto run = [&s, hips = raw_hips<Real>(cache, hips_of(order)),
                      out = std::vector<RawContact<Real>>(kHips)]() mutable {
      constexpr Method kGregory[] = {Method::kGregory};
      kernels<Real>().nearest(s, kGregory, 1, track_options<Real>({}), hips.data(), kHips,
                              out.data());
    };
    return {static_cast<double>(kHips), run};
  });
}

Work kernel_track(Precision precision) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision);
  return with_surface(cache, [&]<class Real>(const Surface<Real>& s) -> Work {
    const Hips h = moved_hips(cache);
    std::vector<RawContact<Real>> starts(kTracked);
    for (std::size_t i = 0; i < kTracked; ++i) place_at(place_of(cache, s, h.points[i]), starts[i]);
    const auto run = [&s, &cache, starts, states = starts,
                      hips = raw_hips<Real>(cache, h.hips)]() mutable {
      states = starts;
      QueryOptions options;
      options.tolerance = patch_tolerance(cache);
      kernels<Real>().track(s, Method::kGregory, track_options<Real>(options), hips.data(),
                            kTracked, states.data());
    };
    return {static_cast<double>(kTracked), run};
  });
}

// The arrays that a caller asks for: SCPs, their normals, and signed distances.
template <class Real>
struct Found {
  std::vector<Real> numbers;

  ContactArrays<Real> arrays(std::size_t count) {
    numbers.resize(7 * count);
    return {.scp = strided_vectors(numbers.data()),
            .normal = strided_vectors(&numbers[3 * count]),
            .distance = {&numbers[6 * count]}};
  }
};

template <class Real>
std::vector<Real> numbers_of(const std::vector<Vec3>& hips) {
  std::vector<Real> numbers;
  for (const Vec3& hip : hips) {
    for (const double x : hip) numbers.push_back(static_cast<Real>(x));
  }
  return numbers;
}

template <class Real>
Work api_nearest(Precision precision, Search order, int threads) {
  std::shared_ptr<ResidentSurface> surface =
      engine_of(threads).reside(cache_of(Shape::kKnot, precision));
  const auto run = [surface, hips = numbers_of<Real>(hips_of(order)),
                    found = Found<Real>()]() mutable {
    constexpr Method kGregory[] = {Method::kGregory};
    const ContactArrays<Real> out = found.arrays(kHips);
    surface->nearest(HipArrays<Real>{kHips, strided_vectors(hips.data())}, kGregory, {}, {&out, 1});
  };
  return {static_cast<double>(kHips), run};
}

template <class Real>
Work api_track(Precision precision, int threads) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision);
  std::shared_ptr<ResidentSurface> surface = engine_of(threads).reside(cache);
  const Hips h = moved_hips(cache);
  std::vector<std::uint32_t> face;
  std::vector<Real> xi, eta;
  for (const DomainPoint& p : h.points) {
    face.push_back(p.face);
    xi.push_back(static_cast<Real>(p.xi));
    eta.push_back(static_cast<Real>(p.eta));
  }
  QueryOptions options;
  options.tolerance = patch_tolerance(cache);
  const auto run = [=, hips = numbers_of<Real>(h.hips), found = Found<Real>()]() mutable {
    const HipArrays<Real> at{kTracked, strided_vectors<const Real>(hips.data())};
    const PointArrays<Real> starts{kTracked, {face.data()}, {xi.data()}, {eta.data()}};
    surface->track(at, starts, options, found.arrays(kTracked));
  };
  return {static_cast<double>(kTracked), run};
}

// HIPs that moved since their contacts were found; errors are distances to where each contact ends,
// of the size.
Work make_track(Precision precision, int threads) {
  const PatchCache& cache = cache_of(Shape::kKnot, precision);
  std::shared_ptr<ResidentSurface> surface = engine_of(threads).reside(cache);
  const Hips h = moved_hips(cache);
  const double size = size_of(cache);
  QueryOptions options;
  std::vector<Contact> contacts(kTracked);
  ContactTracker reference(cache_of(Shape::kKnot, Precision::kDouble), {});
  options.tolerance = patch_tolerance(cache);
  surface->track(h.hips, h.points, options, contacts);
  Work work{static_cast<double>(kTracked), nullptr};
  std::vector<double> errors;
  for (std::size_t i = 0; i < kTracked; ++i) {
    const Contact there = reference.track(h.hips[i], h.points[i]);
    errors.push_back((contacts[i].scp - there.scp).norm() / size);
  }
  std::sort(errors.begin(), errors.end());
  work.counters["error_p999"] = quantile(errors, 0.999);
  work.counters["error_worst"] = errors.back();
  work.counters["solver_iterations"] = iterations_of(contacts);
  work.run = [=]() mutable { surface->track(h.hips, h.points, options, contacts); };
  return work;
}

// One contact that slides 2 mm beneath the surface, 0.15 mm a tick; each tick by itself.
void tick(benchmark::State& state, Precision precision) {
  using Clock = std::chrono::steady_clock;
  const KnotGrid grid = knot_grid(mesh_faces);
  const std::vector<Vec3> path =
      path_beneath(torus_knot(grid.along, grid.around), grid.along, grid.around, 2, 0.15);
  ContactTracker tracker(cache_of(Shape::kKnot, precision), {});
  for (const Vec3& hip : path) tracker.tick(hip);
  std::vector<double> us;
  std::size_t next = 0;
  for (auto _ : state) {
    const Clock::time_point start = Clock::now();
    benchmark::DoNotOptimize(tracker.tick(path[next]));
    const std::chrono::duration<double> took = Clock::now() - start;
    us.push_back(1e6 * took.count());
    next = next + 1 < path.size() ? next + 1 : 0;
  }
  state.counters["items_per_second"] =
      1e6 * static_cast<double>(us.size()) / std::accumulate(us.begin(), us.end(), 0.0);
  std::sort(us.begin(), us.end());
  state.counters["p50_us"] = quantile(us, 0.5);
  state.counters["p99_us"] = quantile(us, 0.99);
}

// A finger that slides about beneath random triangles, 0.5 % of the size deep: contacts that search
// for their way too.
Work make_walk(Precision precision, const Level& level) {
  const PatchCache& cache = cache_of(Shape::kRandom, precision, level);
  const Mesh& mesh = mesh_of(Shape::kRandom);
  const WalkOptions options{.depth = walk_depth(mesh), .walkers = 10, .ticks = 1000};
  const std::vector<Walk> walks = walk_paths(mesh, build_topology(mesh), options);
  double ticks = 0;
  for (const Walk& walk : walks) ticks += static_cast<double>(walk.hips.size());
  return {ticks, [&cache, walks] {
            for (const Walk& walk : walks) {
              ContactTracker tracker(cache, {});
              for (const Vec3& hip : walk.hips) benchmark::DoNotOptimize(tracker.tick(hip));
            }
          }};
}

// HIPs beneath a surface that asks for the winding number of its polygons, as where some fold, or
// that does not.
Work make_folded(Precision precision, bool asks) {
  const auto cache = std::make_shared<PatchCache>(cache_of(Shape::kKnot, precision));
  if (asks) {
    cache->winding = std::visit(
        [](const auto& s) { return std::make_shared<const WindingTree>(s); }, cache->surface);
  }
  return {static_cast<double>(kHips), [cache, hips = hips_of(Search::kRandom)] {
            std::vector<Contact> contacts(hips.size());
            const Method method = Method::kGregory;
            nearest(*cache, hips, {&method, 1}, {}, contacts);
          }};
}

void add_nearest(const std::string& path, const std::string& level, const QueryOptions& options,
                 Precision p, Search order, int threads) {
  std::vector<Rival> rivals;
  if (threads > 1) {
    rivals.push_back({"x_one_thread", [=] { return make_nearest(options, p, order, 1); }});
  } else if (kEmbree && options.method == Method::kGregory && options.solver == Solver::kNewton) {
    if constexpr (kEmbree) {
      rivals.push_back(
          {"x_embree", [=] { return embree_nearest(mesh_of(Shape::kDense), hips_of(order)); }});
    }
  }
  add_work(
      path + "/" + level + "/" + precision_name(p) + "/4/tbb/" + std::to_string(threads), threads,
      [=] { return make_nearest(options, p, order, threads); }, rivals);
}

}  // namespace

void register_queries() {
  for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
    for (const int threads : {1, 2}) {
      add_nearest("nearest", "exact", {}, p, Search::kRandom, threads);
      add_nearest("nearest_spatial", "exact", {}, p, Search::kSpatial, threads);
      std::vector<Rival> rivals;
      if (threads > 1) rivals.push_back({"x_one_thread", [=] { return make_track(p, 1); }});
      add_work(
          work_name("track", kPapers, p, 4, threads), threads,
          [=] { return make_track(p, threads); }, rivals);
    }
    add_work(work_name("nearest_folded", kPapers, p, 4, 1), 1, [=] { return make_folded(p, true); },
             {{"of_plain", [=] { return make_folded(p, false); }}});
    const auto by_precision = [p](auto narrow, auto wide) {
      return p == Precision::kFloat ? narrow() : wide();
    };
    add_work(work_name("api_nearest", kPapers, p, 4, 1), 1,
             [=] {
               return by_precision([=] { return api_nearest<float>(p, Search::kRandom, 1); },
                                   [=] { return api_nearest<double>(p, Search::kRandom, 1); });
             },
             {{"of_kernel", [=] { return kernel_nearest(p, Search::kRandom); }}});
    add_work(work_name("api_track", kPapers, p, 4, 1), 1,
             [=] {
               return by_precision([=] { return api_track<float>(p, 1); },
                                   [=] { return api_track<double>(p, 1); });
             },
             {{"of_kernel", [=] { return kernel_track(p); }}});
    for (const auto& [name, method] : kMethodNames) {
      QueryOptions options;
      options.method = method;
      if (method != Method::kGregory) add_nearest("nearest", name, options, p, Search::kRandom, 1);
    }
    for (const auto& [name, solver] : kSolverNames) {
      QueryOptions options;
      options.solver = solver;
      if (solver != Solver::kNewton)
        add_nearest("nearest", std::string("exact-") + name, options, p, Search::kRandom, 1);
    }
    benchmark::RegisterBenchmark(work_name("tick", kPapers, p, 4, 1).c_str(), tick, p)
        ->Unit(benchmark::kMicrosecond);
    const Level fair{.construction = Construction::kFair};
    const auto walk = [p](const Level& level) { return [=] { return make_walk(p, level); }; };
    add_work(work_name("walk", kPapers, p, 3, 1), 1, walk(kPapers));
    add_work(work_name("walk", fair, p, 3, 1), 1, walk(fair), {{"x_exact", walk(kPapers)}});
  }
  if constexpr (kEmbree) {
    for (const auto& [name, order] : {std::pair{"nearest_46080", Search::kRandom},
                                      {"nearest_46080_spatial", Search::kSpatial}}) {
      add_work(std::string("peer/embree/") + name + "/1", 1,
               [order = order] { return embree_nearest(mesh_of(Shape::kDense), hips_of(order)); });
    }
  }
}

}  // namespace gliss::bench
