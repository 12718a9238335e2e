#include "gliss/surface/instances.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace gliss {

#define GLISS_DECLARE(isa)              \
  namespace isa {                       \
  const Kernels<float>& kernels_f32();  \
  const Kernels<double>& kernels_f64(); \
  }
GLISS_DECLARE(baseline)
GLISS_DECLARE(v3)
GLISS_DECLARE(v4)

namespace {

constexpr const char* kIsaNames[] = {"baseline", "v3", "v4"};

// Index of kIsaNames: never above what the machine can do.
int chosen_isa() {
#if defined(__x86_64__)
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                  __builtin_cpu_supports("bmi2");
  const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  const int best = v4 ? 2 : v3 ? 1 : 0;
#else
  const int best = 0;
#endif
  const char* wish = std::getenv("GLISS_ISA");
  if (wish == nullptr || *wish == '\0') return best;
  const auto named = std::find(std::begin(kIsaNames), std::end(kIsaNames), std::string_view(wish));
  if (named == std::end(kIsaNames)) {
    throw std::invalid_argument("GLISS_ISA: '" + std::string(wish) +
                                "' is not one of baseline, v3, v4");
  }
  return std::min(static_cast<int>(named - std::begin(kIsaNames)), best);
}

}  // namespace

#if defined(GLISS_ONLY_ISA)
#define GLISS_PICK(f) ((void)isa, GLISS_ONLY_ISA::f())
#elif defined(__x86_64__)
#define GLISS_PICK(f) (isa == 2 ? v4::f() : isa == 1 ? v3::f() : baseline::f())
#else
#define GLISS_PICK(f) ((void)isa, baseline::f())
#endif

template <>
const Kernels<float>& kernels<float>() {
  static const int isa = chosen_isa();
  return GLISS_PICK(kernels_f32);
}
template <>
const Kernels<double>& kernels<double>() {
  static const int isa = chosen_isa();
  return GLISS_PICK(kernels_f64);
}

}  // namespace gliss
