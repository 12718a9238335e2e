#include "bench/machine.h"

#include <benchmark/benchmark.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include <cstring>
#include <memory>
#include <type_traits>

#include "bench/benches.h"
#include "bench/meshes.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/names.h"

namespace gliss::bench {
namespace {

constexpr std::size_t kRounds = 1 << 20, kChains = 12;
constexpr std::size_t kNumbers = std::size_t{1} << 24;  // of an array: 64 MiB

// Independent chains, enough to hide what an fma takes. Returns the operations done.
#define GLISS_CHAINS(NAME, TARGET, V, FMA)                                           \
  TARGET std::size_t NAME() {                                                        \
    using Number = std::decay_t<decltype(V{}[0])>;                                   \
    const V zero = {}, a = zero + Number(0.999f), b = zero + Number(1e-4f);          \
    V x[kChains];                                                                    \
    for (std::size_t k = 0; k < kChains; ++k) x[k] = a * static_cast<Number>(k);     \
    for (std::size_t i = 0; i < kRounds; ++i) {                                      \
      _Pragma("GCC unroll 12") for (std::size_t k = 0; k < kChains; ++k) x[k] = FMA; \
    }                                                                                \
    V sum = zero;                                                                    \
    for (std::size_t k = 0; k < kChains; ++k) sum += x[k];                           \
    benchmark::DoNotOptimize(sum);                                                   \
    return 2 * kRounds * kChains * (sizeof(V) / sizeof(sum[0]));                     \
  }
typedef float Float4 __attribute__((vector_size(16)));
typedef double Double2 __attribute__((vector_size(16)));
GLISS_CHAINS(chains_baseline_f32, , Float4, x[k] * a + b)
GLISS_CHAINS(chains_baseline_f64, , Double2, x[k] * a + b)
#if defined(__x86_64__)
#define GLISS_V3 __attribute__((target("avx2,fma")))
#define GLISS_V4 __attribute__((target("avx512f")))
GLISS_CHAINS(chains_v3_f32, GLISS_V3, __m256, _mm256_fmadd_ps(x[k], a, b))
GLISS_CHAINS(chains_v3_f64, GLISS_V3, __m256d, _mm256_fmadd_pd(x[k], a, b))
GLISS_CHAINS(chains_v4_f32, GLISS_V4, __m512, _mm512_fmadd_ps(x[k], a, b))
GLISS_CHAINS(chains_v4_f64, GLISS_V4, __m512d, _mm512_fmadd_pd(x[k], a, b))
#endif

using Chains = std::size_t (*)();

Chains chains_of(Precision precision) {
  const bool f32 = precision == Precision::kFloat;
#if defined(__x86_64__)
  const std::string isa = kernels<float>().isa;
  if (isa == "v4") return f32 ? chains_v4_f32 : chains_v4_f64;
  if (isa == "v3") return f32 ? chains_v3_f32 : chains_v3_f64;
#endif
  return f32 ? chains_baseline_f32 : chains_baseline_f64;
}

// body(begin, end) over an array, a part a thread.
template <class Body>
void over_parts(int threads, Body body) {
  engine_of(threads).for_each(kNumbers, kNumbers / static_cast<std::size_t>(threads), body);
}

using Array = std::vector<float>;
std::shared_ptr<Array> array(float value) { return std::make_shared<Array>(kNumbers, value); }

}  // namespace

Work fma_work(Precision precision, int threads) {
  const Chains chains = chains_of(precision);
  const auto run = [=] {
    engine_of(threads).for_each(static_cast<std::size_t>(threads), 1,
                                [=](std::size_t, std::size_t) { chains(); });
  };
  return {static_cast<double>(chains()) * threads, run};
}

Work read_work(int threads) {
  const auto from = array(1);
  const auto run = [=] {
    over_parts(threads, [&](std::size_t begin, std::size_t end) {
      constexpr std::size_t kApart = 64;  // sums of their own, so that none is waited for
      float sum[kApart] = {};
      for (std::size_t i = begin; i < end; i += kApart) {
        for (std::size_t k = 0; k < kApart; ++k) sum[k] += (*from)[i + k];
      }
      benchmark::DoNotOptimize(sum);
    });
  };
  return {kNumbers * sizeof(float), run};
}

Work write_work(int threads) {
  const auto to = array(0);
  const auto run = [=] {
    over_parts(threads, [&](std::size_t begin, std::size_t end) {
      std::memset(to->data() + begin, 1, (end - begin) * sizeof(float));
      benchmark::ClobberMemory();
    });
  };
  return {kNumbers * sizeof(float), run};
}

Work triad_work(int threads) {
  const auto a = array(0), b = array(1), c = array(2);
  const auto run = [=] {
    over_parts(threads, [&](std::size_t begin, std::size_t end) {
      float* const to = a->data();
      const float *const x = b->data(), *const y = c->data();
      for (std::size_t i = begin; i < end; ++i) to[i] = x[i] + 3 * y[i];
      benchmark::ClobberMemory();
    });
  };
  return {3.0 * kNumbers * sizeof(float), run};
}

void register_machine() {
  for (const int threads : {1, 2}) {
    const std::string end = "/" + std::to_string(threads);
    for (const Precision p : {Precision::kFloat, Precision::kDouble}) {
      std::vector<Rival> rivals;
      if (threads > 1) rivals.push_back({"x_one_thread", [=] { return fma_work(p, 1); }});
      add_work(
          std::string("machine/fma/") + precision_name(p) + end, threads,
          [=] { return fma_work(p, threads); }, rivals);
    }
    add_work("machine/read" + end, threads, [=] { return read_work(threads); });
    add_work("machine/write" + end, threads, [=] { return write_work(threads); });
    add_work("machine/triad" + end, threads, [=] { return triad_work(threads); });
  }
}

}  // namespace gliss::bench
