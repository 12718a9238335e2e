// Positions with both derivatives, by patch and one sample a patch: of the kernels, and (api_...)
// as a caller of the library gets them.
#include <benchmark/benchmark.h>

#include "bench/benches.h"
#include "bench/flops.h"
#include "bench/machine.h"
#include "bench/meshes.h"
#include "bench/peers/peers.h"
#include "bench/samples.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/names.h"

namespace gliss::bench {
namespace {

constexpr std::size_t kGrain = 32;

// A surface, and how it is evaluated.
struct Case {
  std::string path;
  Shape shape;
  Level level;
  Precision precision;
  std::uint32_t n;
  int threads;
};

template <class Real>
void evaluate_at(const Surface<Real>& s, std::uint32_t patch, const Real* xi, const Real* eta,
                 std::size_t count, std::size_t stride, Real* out) {
  const std::uint32_t n = s.valence(patch);
  kernels<Real>().evaluate(&s.domain[s.domain_begin[n]],
                           &s.control[3 * std::size_t{s.control_begin[patch]}], s.form[patch], n,
                           xi, eta, count, stride, out);
}

template <class Real>
std::vector<std::uint32_t> patches_of(const Surface<Real>& s, std::uint32_t n) {
  std::vector<std::uint32_t> patches;
  for (std::uint32_t p = 0; p < s.patch_count(); ++p) {
    if (s.valence(p) == n) patches.push_back(p);
  }
  return patches;
}

// kCallPatches of the patches a call, each at kPatchPoints points.
template <class Real>
Work by_patch(const Surface<Real>& s, const Case& c) {
  auto patches = patches_of(s, c.n);
  Work work{static_cast<double>(kCallPatches * kPatchPoints), nullptr};
  work.counters["flops"] = flops_of_evaluate(s.form[patches[0]], c.n);
  work.counters["bytes"] = 11 * sizeof(Real);
  work.run = [&s, c, patches = std::move(patches), grid = PatchGrid<Real>(c.n),
              first = std::size_t{0}]() mutable {
    engine_of(c.threads).for_each(kCallPatches, kGrain, [&](std::size_t begin, std::size_t end) {
      thread_local std::vector<Real> out(9 * kPatchPoints);
      for (std::size_t i = begin; i < end; ++i) {
        evaluate_at(s, patches[(first + i) % patches.size()], grid.xi.data(), grid.eta.data(),
                    kPatchPoints, kPatchPoints, out.data());
        benchmark::DoNotOptimize(out.data());
      }
    });
    first = (first + kCallPatches) % patches.size();
  };
  return work;
}

template <class Real>
Work shuffled(const Surface<Real>& s, const Case& c) {
  // Rows are not a power of two apart: they would share their place in the cache.
  constexpr std::size_t kStride = kCallPoints + 16;
  const auto out = std::make_shared<std::vector<Real>>(9 * kStride);
  const auto patches = patches_of(s, c.n);
  CallPoints<Real> points(Order::kShuffled, patches.size());
  for (std::uint32_t& p : points.patch) p = patches[p];
  const auto run = [&s, c, points = std::move(points), out] {
    engine_of(c.threads).for_each(kCallPoints, 1024, [&](std::size_t begin, std::size_t end) {
      kernels<Real>().evaluate_each(s, &points.patch[begin], &points.xi[begin], &points.eta[begin],
                                    end - begin, kStride, out->data() + begin);
    });
    benchmark::DoNotOptimize(out->data());
  };
  return {static_cast<double>(kCallPoints), run};
}

// The results of a call: positions and both derivatives, an array for each coordinate.
template <class Real>
struct CallResults {
  std::vector<Real> numbers = std::vector<Real>(9 * kCallPoints);

  SurfaceArrays<Real> arrays() {
    const auto vectors = [&](std::size_t row) {
      Real* x = &numbers[row * kCallPoints];
      return strided_vectors(x, x + kCallPoints, x + 2 * kCallPoints);
    };
    return {.position = vectors(0), .d_xi = vectors(3), .d_eta = vectors(6)};
  }
};

template <class Real>
Work api_points(const Surface<Real>& s, const Case& c, Order order) {
  const std::shared_ptr<ResidentSurface> surface =
      engine_of(c.threads).reside(cache_of(c.shape, c.precision, c.level));
  const auto patches = patches_of(s, c.n);
  CallPoints<Real> points(order, patches.size(), c.n);
  for (std::uint32_t& p : points.patch) p = patches[p];
  const auto run = [surface, points, out = std::make_shared<CallResults<Real>>()] {
    surface->evaluate(
        PointArrays<Real>{
            points.patch.size(), {points.patch.data()}, {points.xi.data()}, {points.eta.data()}},
        out->arrays());
  };
  return {static_cast<double>(kCallPoints), run, {{"bytes", 11 * sizeof(Real) + 4}}};
}

template <class Real>
Work api_grid(const Surface<Real>& s, const Case& c) {
  const std::shared_ptr<ResidentSurface> surface =
      engine_of(c.threads).reside(cache_of(c.shape, c.precision, c.level));
  const auto patches = patches_of(s, c.n);
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < kCallPoints / kPatchPoints; ++i)
    faces.push_back(patches[i % patches.size()]);
  const auto run = [=, grid = PatchGrid<Real>(c.n), out = std::make_shared<CallResults<Real>>()] {
    surface->evaluate_grid(faces, std::span<const Real>(grid.xi), std::span<const Real>(grid.eta),
                           out->arrays());
  };
  return {static_cast<double>(kCallPoints), run, {{"bytes", 9 * sizeof(Real)}}};
}

bool is_shuffled(const Case& c) { return c.path.find("shuffled") != std::string::npos; }
Order order_of(const Case& c) { return is_shuffled(c) ? Order::kShuffled : Order::kByPatch; }
bool is_api(const Case& c) { return c.path.starts_with("api_"); }

Work make(const Case& c) {
  return std::visit(
      [&](const auto& s) {
        if (c.path == "api_grid") return api_grid(s, c);
        if (is_api(c)) return api_points(s, c, order_of(c));
        return is_shuffled(c) ? shuffled(s, c) : by_patch(s, c);
      },
      cache_of(c.shape, c.precision, c.level).surface);
}

// The rivals that each is compared with: less of the same, the machine, peers.
std::vector<Rival> rivals_of(const Case& c) {
  const auto like = [](Case other) { return [=] { return make(other); }; };
  std::vector<Rival> rivals;
  Case other = c;
  if (c.threads > 1) {
    other.threads = 1;
    rivals.push_back({"x_one_thread", like(other)});
    return rivals;
  }
  if (is_api(c)) {
    other.path = is_shuffled(c) ? "evaluate_shuffled" : "evaluate";
    rivals.push_back({"of_kernel", like(other)});
    other = c;
    if (!is_shuffled(c)) rivals.push_back({"of_triad", [] { return triad_work(1); }, "bytes"});
  }
  if (c.level != kPapers) {
    other.level = kPapers;
    rivals.push_back({"x_exact", like(other)});
  }
  if (c.precision == Precision::kDouble) {
    other = c;
    other.precision = Precision::kFloat;
    rivals.push_back({"x_float", like(other)});
  }
  if (!is_api(c) && !is_shuffled(c))
    rivals.push_back({"of_peak", [=] { return fma_work(c.precision, 1); }, "flops"});
  if (is_api(c) && c.n == 4 && c.precision == Precision::kFloat) {
    const Order order = order_of(c);
    if constexpr (kOpenSubdiv) {
      rivals.push_back(
          {"x_opensubdiv", [=] { return opensubdiv_evaluate(mesh_of(c.shape), order); }});
    }
    if constexpr (kEmbree)
      rivals.push_back({"x_embree", [=] { return embree_evaluate(mesh_of(c.shape), order); }});
  }
  return rivals;
}

void add(const Case& c) {
  add_work(
      work_name(c.path, c.level, c.precision, c.n, c.threads), c.threads, [=] { return make(c); },
      rivals_of(c));
}

}  // namespace

void register_evaluate() {
  for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
    for (const char* name : {"exact", "ribbon", "bezier", "table", "fair"}) {
      const Level level = find_surface(name).value();
      for (const int threads : {1, 2}) {
        for (const std::uint32_t n : {4u, 3u, 5u, 6u}) {
          // The paper's patches again.
          if (n > 4 && level.construction == Construction::kFair) continue;
          add({"evaluate", shape_of(n), level, p, n, threads});
        }
        add({"evaluate_irregular", Shape::kIrregular, level, p, 4, threads});
        add({"evaluate_shuffled", Shape::kKnot, level, p, 4, threads});
        for (const std::uint32_t n : {4u, 3u})
          add({"api_evaluate", shape_of(n), level, p, n, threads});
        add({"api_evaluate_irregular", Shape::kIrregular, level, p, 4, threads});
        add({"api_grid", Shape::kKnot, level, p, 4, threads});
        add({"api_evaluate_shuffled", Shape::kKnot, level, p, 4, threads});
      }
    }
  }
}

void register_peers() {
  const auto add_evaluate = [](const std::string& peer, auto evaluate) {
    for (const Shape shape : {Shape::kIrregular, Shape::kKnot}) {
      const std::string kind = shape == Shape::kKnot ? "regular" : "irregular";
      add_work(peer + "/evaluate_" + kind + "/1", 1,
               [=] { return evaluate(mesh_of(shape), Order::kByPatch); });
      add_work(peer + "/evaluate_" + kind + "_shuffled/1", 1,
               [=] { return evaluate(mesh_of(shape), Order::kShuffled); });
    }
  };
  if constexpr (kOpenSubdiv) add_evaluate("peer/opensubdiv", opensubdiv_evaluate);
  if constexpr (kEmbree) add_evaluate("peer/embree", embree_evaluate);
}

}  // namespace gliss::bench
