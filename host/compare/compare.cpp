#include "gliss/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/base/require.h"
#include "gliss/base/stopwatch.h"
#include "gliss/build/build_cache.h"
#include "gliss/compare/recommend.h"
#include "gliss/compare/tessellate.h"

namespace gliss {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kPoints = 20000, kPointsPerFace = 64, kMostPoints = 1000000;
constexpr double kMeasureFor = 0.1;      // s, each rate
constexpr double kFarthestGuess = 1000;  // times the triangles that were tried
constexpr std::size_t kGrain = 256;      // points measured between two polls
constexpr int kRides = 5;                // along each path, for the time of a tick

// Items a second of work that does `items` at a time.
template <class Work>
double rate_of(std::size_t items, const Poll& poll, Work work) {
  poll();
  work();  // memory touched, kernels compiled
  const Stopwatch clock;
  std::size_t rounds = 0;
  double seconds = 0;
  do {
    poll();
    work();
    ++rounds;
    seconds = clock.seconds();
  } while (seconds < kMeasureFor);
  return static_cast<double>(items * rounds) / seconds;
}

}  // namespace

struct Comparison::Surface {
  CompareCandidate candidate;
  PatchCache cache;
  double seconds = 0;  // to build it
};

Comparison::Comparison(const Mesh& mesh, const Topology& topology, std::vector<ComparePath> paths,
                       CompareWalks walks, TrueDistance distance, CompareOptions options)
    : mesh_(mesh),
      paths_(std::move(paths)),
      walks_(std::move(walks)),
      distance_(std::move(distance)),
      options_(std::move(options)),
      topology_(topology) {
  require(is_stiffness(options_.stiffness), "CompareOptions has a stiffness that is not 0 or more");
  if (!options_.normals_given) {
    smooth_mesh_ = mesh;
    smooth_mesh_.normals.clear();
    smooth_mesh_.corner_normal.clear();
    smooth_mesh_.tangents.clear();
    complete_mesh(smooth_mesh_, Construction::kFair);
  }
  for (const CompareCandidate& c : options_.candidates) {
    if (c.method == Method::kGregory && find_exact(c.level.construction) == nullptr)
      add_exact(c.level.construction);
  }
  if (exact_.empty()) add_exact(Level{}.construction);
  for (const SurfacePoint& p : exact_.front().points)
    hips_.push_back(p.position - paths_.front().depth / mesh.unit * p.normal);
}

void Comparison::add_exact(Construction construction) {
  BuildOptions build;
  build.level.construction = construction;
  const auto engine = engine_of(options_.backends.front());
  Exact exact{construction, build_cache(mesh_of(construction), topology_, build, nullptr,
                                        engine->build_backend())};
  if (points_.empty()) {
    const std::size_t faces = exact.cache.mesh_face_count;
    points_ = spread_points(exact.cache, kPoints);
    many_points_ = spread_points(exact.cache, std::min(kPointsPerFace * faces, kMostPoints));
  }
  exact.points.resize(points_.size());
  evaluate(exact.cache, points_, exact.points);
  for (const ComparePath& path : paths_) {
    const double depth = path.depth / mesh_.unit;
    QueryOptions ideal;
    ideal.settle = options_.settle;  // so that the reference has no error from itself
    exact.pushes.push_back(feel_path(exact.cache, ideal, path.hips, depth, {}, options_.poll).push);
  }
  exact_.push_back(std::move(exact));
}

// Each construction has normals of its own where the mesh was given none.
const Mesh& Comparison::mesh_of(Construction construction) const {
  const bool is_smooth = normal_weights(construction) == NormalWeights::kSmooth;
  return is_smooth && !options_.normals_given ? smooth_mesh_ : mesh_;
}

const Comparison::Exact* Comparison::find_exact(Construction construction) const {
  for (const Exact& exact : exact_) {
    if (exact.construction == construction) return &exact;
  }
  return nullptr;
}

const Comparison::Exact& Comparison::exact_of(const CompareCandidate& candidate) const {
  const Exact* own =
      candidate.method == Method::kGregory ? find_exact(candidate.level.construction) : nullptr;
  return own != nullptr ? *own : exact_.front();
}

std::vector<std::pair<Construction, SurfacePicture>> Comparison::pictures(
    std::size_t most_points) const {
  std::vector<std::pair<Construction, SurfacePicture>> made;
  for (const Exact& exact : exact_) {
    options_.poll();
    made.emplace_back(exact.construction, picture_of(exact.cache, most_points));
  }
  return made;
}

std::size_t Comparison::row_count() const {
  return options_.candidates.size() * options_.precisions.size() * options_.backends.size() *
         options_.solvers.size();
}

ParallelFor Comparison::polled(const Engine& engine) const {
  return [&](std::size_t count, std::size_t grain, const auto& body) {
    engine.for_each(count, grain, [&](std::size_t begin, std::size_t end) {
      options_.poll();
      body(begin, end);
    });
  };
}

std::unique_ptr<Engine> Comparison::engine_of(const std::string& backend) const {
  if (options_.make_engine) return options_.make_engine(backend);
  if (backend == "tbb") return make_tbb_engine();
  if (backend == "serial") return make_serial_engine();
  throw std::invalid_argument("a comparison on '" + backend +
                              "' needs CompareOptions::make_engine");
}

std::vector<CompareRow> Comparison::measure(const std::function<void()>& measured) const {
  const PlainArithmetic plain;
  std::vector<CompareRow> rows;
  for (const CompareCandidate& candidate : options_.candidates) {
    for (const Precision precision : options_.precisions) {
      std::vector<CompareRow> felt;  // by solver: what does not depend on the backend
      for (const std::string& backend : options_.backends) {
        const auto engine = engine_of(backend);
        const Surface surface = build(candidate, precision, *engine);
        if (felt.empty()) {
          CompareRow shape{candidate, precision, Solver::kNewton, ""};
          measure_shape(surface, *engine, shape);
          for (const Solver solver : options_.solvers) {
            felt.push_back(shape);
            felt.back().solver = solver;
            measure_feel(surface.cache, query_of(candidate, solver), exact_of(candidate),
                         felt.back());
            measure_walks(surface.cache, query_of(candidate, solver), *engine, felt.back());
          }
        }
        const auto resident = engine->reside(surface.cache);
        const double evaluations =
            candidate.method == Method::kGregory ? evaluation_rate(*resident) : kUnknown;
        for (CompareRow row : felt) {
          row.backend = backend;
          row.build_per_s = static_cast<double>(mesh_.face_count()) / surface.seconds;
          row.eval_per_s = evaluations;
          row.track_per_s = tracking_rate(*resident, query_of(candidate, row.solver));
          rows.push_back(row);
          if (measured) measured();
        }
      }
    }
  }
  mark_pareto(rows);
  return rows;
}

QueryOptions Comparison::query_of(const CompareCandidate& candidate, Solver solver) const {
  QueryOptions query{options_.solving, candidate.method};
  query.solver = solver;
  query.settle = options_.settle;
  return query;
}

Comparison::Surface Comparison::build(const CompareCandidate& candidate, Precision precision,
                                      const Engine& engine) const {
  Surface surface{candidate, {}, 0};
  const Stopwatch clock;
  if (candidate.method == Method::kGregory) {
    BuildOptions options;
    options.precision = precision;
    options.level = candidate.level;
    surface.cache = build_cache(mesh_of(candidate.level.construction), topology_, options, nullptr,
                                engine.build_backend());
  } else {
    const Mesh& mesh = options_.baseline != nullptr ? *options_.baseline : mesh_;
    surface.cache = build_base(mesh, topology_, precision);
  }
  surface.seconds = clock.seconds();
  return surface;
}

void Comparison::measure_shape(const Surface& surface, const Engine& engine,
                               CompareRow& row) const {
  options_.poll();
  const PatchCache& cache = surface.cache;
  const Method method = surface.candidate.method;
  const Exact& exact = exact_of(surface.candidate);
  QueryOptions flat;
  flat.method = Method::kFlat;
  row.bytes = static_cast<double>(cache.bytes());
  row.bytes_per_patch = row.bytes / cache.patch_count();
  const Distances gaps = normal_gaps(mesh_, topology_, cache, method);
  row.max_normal_gap = gaps.largest;
  row.p99_normal_gap = gaps.p99;
  std::vector<Vec3> there(points_.size());  // on the surface
  std::vector<double> distance(points_.size());
  polled(engine)(points_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (method == Method::kGregory) {
      const std::size_t count = end - begin;
      const std::span places = std::span(points_).subspan(begin, count);
      std::vector<SurfacePoint> points(count);
      evaluate(cache, places, points);
      for (std::size_t i = begin; i < end; ++i) there[i] = points[i - begin].position;
      std::vector<Contact> contacts(count);
      track(exact.cache, std::span(there).subspan(begin, count), places, {}, contacts);
      for (std::size_t i = begin; i < end; ++i) {
        // Within another part the contact lies elsewhere.
        const double same = (there[i] - exact.points[i].position).norm();
        distance[i] = std::min(std::abs(contacts[i - begin].distance), same);
      }
    } else {
      for (std::size_t i = begin; i < end; ++i) {
        const Contact contact = nearest(cache, exact.points[i].position, flat);
        there[i] = contact.scp;
        distance[i] = std::abs(contact.distance);
      }
    }
  });
  const Distances to_exact = distances_of(distance);
  row.max_distance = to_exact.largest * mesh_.unit;
  row.p99_distance = to_exact.p99 * mesh_.unit;
  row.true_max_distance = row.true_p99_distance = kUnknown;
  if (!distance_) return;
  for (std::size_t i = 0; i < there.size(); ++i) distance[i] = distance_(there[i]);
  const Distances to_truth = distances_of(distance);
  row.true_max_distance = to_truth.largest * mesh_.unit;
  row.true_p99_distance = to_truth.p99 * mesh_.unit;
}

void Comparison::measure_feel(const PatchCache& cache, const QueryOptions& query,
                              const Exact& exact, CompareRow& row) const {
  row.max_force_step = row.p99_force_step = row.max_force_error = row.p99_force_error = 0;
  row.tick = row.jumps_per_100k = row.lost_per_100k = row.settling_share = 0;
  row.unsound = 0;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const ComparePath& path = paths_[i];
    const double depth = path.depth / mesh_.unit;
    const FeltPath felt = feel_path(cache, query, path.hips, depth, exact.pushes[i], options_.poll);
    const double newtons = options_.stiffness * mesh_.unit;
    row.max_force_step = std::max(row.max_force_step, newtons * felt.force.largest_step);
    row.p99_force_step = std::max(row.p99_force_step, newtons * felt.p99_step);
    row.jumps_per_100k = std::max(row.jumps_per_100k, felt.force.jumps_per_100k());
    row.lost_per_100k = std::max(row.lost_per_100k, felt.force.lost_per_100k());
    row.settling_share = std::max(row.settling_share, felt.force.settling_share());
    row.unsound += felt.force.unsound;
    row.max_force_error = std::max(row.max_force_error, felt.error.largest / depth);
    row.p99_force_error = std::max(row.p99_force_error, felt.error.p99 / depth);
    double tick = felt.median_tick;  // the best of some: others use the machine as well
    for (int ride = 1; ride < kRides; ++ride)
      tick =
          std::min(tick, feel_path(cache, query, path.hips, depth, {}, options_.poll).median_tick);
    row.tick = std::max(row.tick, tick);
  }
}

void Comparison::measure_walks(const PatchCache& cache, const QueryOptions& query,
                               const Engine& engine, CompareRow& row) const {
  row.walk_max_force_step = row.walk_p99_force_step = kUnknown;
  row.steps_beyond_2dx_per_100k = row.max_step_beyond_2dx = kUnknown;
  row.loop_gain = loop_gain(cache, query, walks_.loops, options_.poll);
  row.leaving = feel_leaving(cache, query, walks_.leaving, polled(engine));
  const double depth = walks_.depth / mesh_.unit;
  for (const WalkSet& set : walks_.sets) {
    for (const double settle : {0.0, query.settle > 0 ? query.settle : QueryOptions{}.settle}) {
      QueryOptions settling = query;
      settling.settle = settle;
      const bool is_main = &set == &walks_.sets.front() && settle == query.settle;
      const bool with_jumps = is_main && options_.most_jumps > 0;
      const FeltWalks felt = feel_walks(cache, settling, set.walks, depth, polled(engine),
                                        with_jumps ? &row.jumps : nullptr);
      row.walks.push_back({set.step * walks_.depth, settle, felt});
      row.unsound += felt.unsound;
      if (is_main) take_walks(felt, row);
    }
  }
  std::stable_sort(row.jumps.begin(), row.jumps.end(),
                   [](const WalkJump& a, const WalkJump& b) { return a.step > b.step; });
  if (row.jumps.size() > options_.most_jumps) row.jumps.resize(options_.most_jumps);
}

void Comparison::take_walks(const FeltWalks& felt, CompareRow& row) const {
  const double newtons = options_.stiffness * mesh_.unit;
  row.walk_max_force_step = newtons * felt.largest_step;
  row.walk_p99_force_step = newtons * felt.p99_step;
  row.steps_beyond_2dx_per_100k = felt.steps_beyond_2dx_per_100k();
  row.max_step_beyond_2dx = newtons * felt.largest_beyond_2dx;
  row.jumps_per_100k = felt.jumps_per_100k();
  row.lost_per_100k = felt.lost_per_100k();
  row.settling_share = felt.settling_share();
}

double Comparison::evaluation_rate(const ResidentSurface& resident) const {
  std::vector<SurfacePoint> points(many_points_.size());
  return rate_of(points.size(), options_.poll, [&] { resident.evaluate(many_points_, points); });
}

double Comparison::tracking_rate(const ResidentSurface& resident, const QueryOptions& query) const {
  std::vector<Contact> contacts(hips_.size());
  return rate_of(hips_.size(), options_.poll,
                 [&] { resident.track(hips_, points_, query, contacts); });
}

DenseRow Comparison::match(Method method, const CompareRow& target, std::uint64_t limit) const {
  const Exact& exact = exact_of(target.candidate);
  const auto engine = engine_of(options_.backends.front());
  BuildBackend backend;
  backend.parallel = polled(*engine);
  backend.poll = options_.poll;
  DenseRow row;
  row.method = method;
  row.target = target.candidate.name();
  row.target_step = target.max_force_step;
  double last_step = 0, last_triangles = 0;
  // Half as many again along a side each time.
  for (std::uint32_t cells = 1; tessellated_count(mesh_, exact.cache, cells) <= limit || cells == 1;
       cells = cells < 2 ? cells + 1 : cells + cells / 2) {
    options_.poll();
    const Mesh dense = tessellate(mesh_, exact.cache, cells, backend.parallel, options_.poll);
    options_.poll();
    const Topology topology = build_topology(dense);
    options_.poll();
    const PatchCache cache = build_base(dense, topology, Precision::kDouble, backend);
    CompareRow felt{};
    measure_feel(cache, query_of({method, {}}, Solver::kNewton), exact, felt);
    last_step = row.max_force_step;
    last_triangles = static_cast<double>(row.triangles);
    row.triangles = dense.face_count();
    row.bytes = static_cast<double>(cache.bytes());
    row.max_force_step = felt.max_force_step;
    row.p99_force_step = felt.p99_force_step;
    row.jumps_per_100k = felt.jumps_per_100k;
    row.lost_per_100k = felt.lost_per_100k;
    row.tick = felt.tick;
    row.reached = felt.max_force_step <= target.max_force_step;
    if (row.reached) break;
  }
  row.memory_ratio = row.bytes / target.bytes;
  row.time_ratio = row.tick / target.tick;
  row.needed_triangles = static_cast<double>(row.triangles);
  if (!row.reached) {
    const double slope = std::log(row.max_force_step / last_step) /
                         std::log(static_cast<double>(row.triangles) / last_triangles);
    const double times = last_step > 0 && slope < 0
                             ? std::pow(target.max_force_step / row.max_force_step, 1 / slope)
                             : kUnknown;
    row.needed_triangles = times < kFarthestGuess ? times * row.needed_triangles : kUnknown;
  }
  return row;
}

}  // namespace gliss
