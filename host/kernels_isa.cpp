// The C++ instances of the kernels for one instruction set, GLISS_ISA.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/kernels.h"
#include "kernels/lanes.h"

#if defined(__AVX512F__)
#define GLISS_VECTOR_BYTES 64
#elif defined(__AVX2__)
#define GLISS_VECTOR_BYTES 32
#else
#define GLISS_VECTOR_BYTES 16
#endif
// sqrt of immintrin.h reads a register that it need not define.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"

namespace {
namespace f32 {
#define GLISS_SCALAR float
#define GLISS_SCALAR_BYTES 4
#include "host/kernels_precision.inc"
#undef GLISS_SCALAR_BYTES
#undef GLISS_SCALAR
}  // namespace f32
namespace f64 {
#define GLISS_SCALAR double
#define GLISS_SCALAR_BYTES 8
#include "host/kernels_precision.inc"
#undef GLISS_SCALAR_BYTES
#undef GLISS_SCALAR
}  // namespace f64
}  // namespace

#define GLISS_STRING_(x) #x
#define GLISS_STRING(x) GLISS_STRING_(x)

namespace gliss::GLISS_ISA {
#define GLISS_TABLE(NAME, REAL, SPACE)                                                \
  const Kernels<REAL>& NAME() {                                                       \
    static const Kernels<REAL> table = {                                              \
        GLISS_STRING(GLISS_ISA), static_cast<int>(GLISS_VECTOR_BYTES / sizeof(REAL)), \
        SPACE::domain_reals,     SPACE::fill_domain,                                  \
        SPACE::probe_rings,      SPACE::probes_of,                                    \
        SPACE::probe_reals,      SPACE::fill_probes,                                  \
        SPACE::build_patches,    SPACE::ease_patch,                                   \
        SPACE::bend_patch,       SPACE::control_reals_of,                             \
        SPACE::bake_patch,       SPACE::wide::evaluate_points,                        \
        SPACE::evaluate_each,    SPACE::wide::shape_of,                               \
        SPACE::side_normal_at,   SPACE::nearest_each,                                 \
        SPACE::track_each,       SPACE::tick_state};                                  \
    return table;                                                                     \
  }
GLISS_TABLE(kernels_f32, float, f32)
GLISS_TABLE(kernels_f64, double, f64)
}  // namespace gliss::GLISS_ISA
