// From a mesh's arrays to control data; and the whole build, which also looks for folds, bounds and
// curvatures and makes the hierarchy, as gliss bake does.
#include <benchmark/benchmark.h>

#include "bench/benches.h"
#include "bench/flops.h"
#include "bench/machine.h"
#include "bench/meshes.h"
#include "gliss/base/large_array.h"
#include "gliss/build/build_cache.h"
#include "gliss/surface/layout.h"
#include "gliss/surface/names.h"

namespace gliss::bench {
namespace {

constexpr std::size_t kGrain = 64, kMostSides = 8;

// Faces of n sides, each in the frame of its first corner.
template <class Real>
Work control_work(std::uint32_t n, int threads) {
  const Mesh& mesh = mesh_of(shape_of(n));
  std::vector<std::uint32_t> faces;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (mesh.valence(f) == n) faces.push_back(f);
  }
  const auto control = std::make_shared<LargeArray<Real>>(faces.size() * n * kSideReals);
  Work work{static_cast<double>(faces.size()), nullptr};
  work.counters["flops"] = flops_of_build(n);
  work.counters["bytes"] = static_cast<double>(n * (6 + kSideReals) * sizeof(Real));
  work.run = [&mesh, n, threads, control, faces = std::move(faces)] {
    engine_of(threads).for_each(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      Real corners[kGrain * 6 * kMostSides], soundness[kGrain];
      Real* next = corners;
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t first = mesh.face_begin[faces[i]];
        const Vec3& origin = mesh.positions[mesh.corner_vertex[first]];
        for (std::uint32_t c = first; c < first + n; ++c) {
          const Vec3 position = mesh.positions[mesh.corner_vertex[c]] - origin;
          const Vec3& normal = mesh.normals[mesh.corner_normal[c]];
          for (const Vec3* v : {&position, &normal}) {
            for (int k = 0; k < 3; ++k) *next++ = static_cast<Real>((*v)[k]);
          }
        }
      }
      kernels<Real>().build_patches(corners, n, end - begin,
                                    control->data() + begin * n * kSideReals, soundness);
    });
    benchmark::DoNotOptimize(control->data());
  };
  return work;
}

Work make_control(Precision precision, std::uint32_t n, int threads) {
  return precision == Precision::kFloat ? control_work<float>(n, threads)
                                        : control_work<double>(n, threads);
}

Work make_checked(Shape shape, const Level& level, Precision precision, int threads) {
  const Mesh& mesh = mesh_of(shape);
  BuildOptions options;
  options.precision = precision;
  options.level = level;
  return {static_cast<double>(mesh.face_count()), [&mesh, options, threads] {
            benchmark::DoNotOptimize(engine_of(threads).build(mesh, options));
          }};
}

}  // namespace

void register_build() {
  for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
    for (const int threads : {1, 2}) {
      for (const std::uint32_t n : {4u, 3u, 6u}) {
        std::vector<Rival> rivals;
        if (threads > 1) {
          rivals.push_back({"x_one_thread", [=] { return make_control(p, n, 1); }});
        } else {
          rivals.push_back({"of_peak", [=] { return fma_work(p, 1); }, "flops"});
          rivals.push_back({"of_bandwidth", [] { return triad_work(1); }, "bytes"});
        }
        add_work(
            work_name("build", kPapers, p, n, threads), threads,
            [=] { return make_control(p, n, threads); }, rivals);
      }
      for (const char* name : {"exact", "ribbon", "bezier", "table", "fair"}) {
        const Level level = find_surface(name).value();
        std::vector<Rival> rivals;
        if (threads > 1)
          rivals.push_back(
              {"x_one_thread", [=] { return make_checked(shape_of(4), level, p, 1); }});
        add_work(
            work_name("build_checked", level, p, 4, threads), threads,
            [=] { return make_checked(shape_of(4), level, p, threads); }, rivals);
        if (threads > 1 || level.kind != Level::kExact) continue;
        for (const std::uint32_t n : {3u, 6u}) {
          add_work(work_name("build_checked", level, p, n, 1), 1,
                   [=] { return make_checked(shape_of(n), level, p, 1); }, {});
        }
        add_work(work_name("build_checked_irregular", level, p, 3, 1), 1,
                 [=] { return make_checked(Shape::kRandom, level, p, 1); }, {});
      }
    }
  }
}

}  // namespace gliss::bench
