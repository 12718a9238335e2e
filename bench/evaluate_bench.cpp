// Positions with both derivatives, by patch and one sample a patch.
#include <benchmark/benchmark.h>

#include "bench/benches.h"
#include "bench/flops.h"
#include "bench/machine.h"
#include "bench/meshes.h"
#include "bench/peers/peers.h"
#include "bench/samples.h"
#include "gliss/surface/names.h"

namespace gliss::bench {
namespace {

constexpr std::size_t kGrain = 32;

// Which surface, and how.
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
  constexpr std::size_t kStride = kShuffledPoints + 16;
  const auto out = std::make_shared<std::vector<Real>>(9 * kStride);
  const auto patches = patches_of(s, c.n);
  ShuffledPoints<Real> points(patches.size());
  for (std::uint32_t& p : points.patch) p = patches[p];
  const auto run = [&s, c, points = std::move(points), out] {
    engine_of(c.threads).for_each(kShuffledPoints, 1024, [&](std::size_t begin, std::size_t end) {
      kernels<Real>().evaluate_each(s, &points.patch[begin], &points.xi[begin], &points.eta[begin],
                                    end - begin, kStride, out->data() + begin);
    });
    benchmark::DoNotOptimize(out->data());
  };
  return {static_cast<double>(kShuffledPoints), run};
}

Work make(const Case& c) {
  return std::visit(
      [&](const auto& s) {
        return c.path == "evaluate_shuffled" ? shuffled(s, c) : by_patch(s, c);
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
  const bool is_shuffled = c.path == "evaluate_shuffled";
  if (c.level != kPapers) {
    other.level = kPapers;
    rivals.push_back({"x_exact", like(other)});
  }
  if (c.precision == Precision::kDouble) {
    other = c;
    other.precision = Precision::kFloat;
    rivals.push_back({"x_float", like(other)});
  }
  if (!is_shuffled)
    rivals.push_back({"of_peak", [=] { return fma_work(c.precision, 1); }, "flops"});
  if (c.n == 4 && c.precision == Precision::kFloat) {
    const Order order = is_shuffled ? Order::kShuffled : Order::kByPatch;
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
