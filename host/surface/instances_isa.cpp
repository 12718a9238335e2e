// The C++ instances of the kernels for one instruction set, GLISS_ISA, and one precision:
// GLISS_BITS of it, 32 or 64. Two objects rather than one of both, so that they compile at the same
// time.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "gliss/surface/instances.h"
#include "kernels/lanes.h"

#if defined(__AVX512F__)
#define GLISS_VECTOR_BYTES 64
#elif defined(__AVX2__)
#define GLISS_VECTOR_BYTES 32
#else
#define GLISS_VECTOR_BYTES 16
#endif
#if GLISS_BITS == 32
#define GLISS_SCALAR float
#define GLISS_TABLE kernels_f32
#else
#define GLISS_SCALAR double
#define GLISS_TABLE kernels_f64
#endif
#define GLISS_SCALAR_BYTES (GLISS_BITS / 8)
// sqrt of immintrin.h reads a register that it need not define.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"

namespace {
namespace instance {
#include "gliss/surface/instances_precision.inc"
}  // namespace instance
}  // namespace

#define GLISS_STRING_(x) #x
#define GLISS_STRING(x) GLISS_STRING_(x)

namespace gliss::GLISS_ISA {

#if GLISS_BITS == 64
#define GLISS_IN_DOUBLE(f) f
#else
#define GLISS_IN_DOUBLE(f) nullptr
#endif

const Kernels<GLISS_SCALAR>& GLISS_TABLE() {
  static const Kernels<GLISS_SCALAR> table = {
      GLISS_STRING(GLISS_ISA),
      static_cast<int>(GLISS_VECTOR_BYTES / GLISS_SCALAR_BYTES),
      instance::domain_reals,
      instance::fill_domain,
      instance::probe_rings,
      instance::coarse_probes_of,
      instance::place_of_probe,
      instance::probes_of,
      instance::probe_reals,
      instance::fill_probes,
      instance::second_reals,
      instance::fill_second_of,
      instance::build_patches,
      instance::build_sharp_patch,
      instance::ease_patch,
      instance::bend_patch,
      instance::control_reals_of,
      instance::to_form_of,
      instance::to_table,
      GLISS_IN_DOUBLE(instance::packed::vertices_of),
      GLISS_IN_DOUBLE(instance::packed::sides_of),
      GLISS_IN_DOUBLE(instance::packed::fair_controls_of),
      instance::wide::evaluate_points,
      instance::evaluate_each,
      instance::place_points<double>,
      instance::place_points<float>,
      instance::wide::shape_of,
      GLISS_IN_DOUBLE(instance::wide::sample),
      GLISS_IN_DOUBLE(instance::wide::least_cosine_of),
      GLISS_IN_DOUBLE(instance::wide::cut),
      GLISS_IN_DOUBLE(instance::wide::add_curves),
      instance::side_normal_at,
      instance::nearest_each,
      instance::track_each,
      instance::tick_state};
  return table;
}

}  // namespace gliss::GLISS_ISA
