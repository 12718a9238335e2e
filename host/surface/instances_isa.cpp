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
      .isa = GLISS_STRING(GLISS_ISA),
      .lanes = static_cast<int>(GLISS_VECTOR_BYTES / GLISS_SCALAR_BYTES),
      .domain_reals = instance::domain_reals,
      .fill_domain = instance::fill_domain,
      .probe_levels = instance::probe_rings,
      .probe_coarse = instance::coarse_probes_of,
      .probe_place = instance::place_of_probe,
      .probe_count = instance::probes_of,
      .probe_reals = instance::probe_reals,
      .fill_probes = instance::fill_probes,
      .second_reals = instance::second_reals,
      .fill_second = instance::fill_second_of,
      .build_patches = instance::build_patches,
      .build_sharp_patch = instance::build_sharp_patch,
      .ease_patch = instance::ease_patch,
      .flatten_tangents = instance::flatten_tangents,
      .control_reals = instance::control_reals_of,
      .to_form = instance::to_form_of,
      .to_table = instance::to_table,
      .fair_vertices = GLISS_IN_DOUBLE(instance::packed::vertices_of),
      .fair_sides = GLISS_IN_DOUBLE(instance::packed::sides_of),
      .fair_controls = GLISS_IN_DOUBLE(instance::packed::fair_controls_of),
      .evaluate = instance::wide::evaluate_points,
      .evaluate_each = instance::evaluate_each,
      .place_double = instance::place_points<double>,
      .place_float = instance::place_points<float>,
      .examine = instance::wide::shape_of,
      .sample = GLISS_IN_DOUBLE(instance::wide::sample),
      .least_cosine = GLISS_IN_DOUBLE(instance::wide::least_cosine_of),
      .cut = GLISS_IN_DOUBLE(instance::wide::cut),
      .add_curves = GLISS_IN_DOUBLE(instance::wide::add_curves),
      .side_normal = instance::side_normal_at,
      .nearest = instance::nearest_each,
      .track = instance::track_each,
      .tick = instance::tick_state,
  };
  return table;
}

}  // namespace gliss::GLISS_ISA
