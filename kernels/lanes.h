// fma and sqrt over the lanes of GCC and Clang vector types, for the C++ instances of the kernels.
#pragma once

#include <cstddef>
#include <utility>

#if defined(__AVX2__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace gliss::lanes {

// Without an instruction for it, lane by lane: slow, and the same bits.
template <class V>
inline V fma(V a, V b, V c) {
  V r;
  for (unsigned i = 0; i < sizeof(V) / sizeof(a[0]); ++i) {
    if constexpr (sizeof(a[0]) == 4) {
      r[i] = __builtin_fmaf(a[i], b[i], c[i]);
    } else {
      r[i] = __builtin_fma(a[i], b[i], c[i]);
    }
  }
  return r;
}
template <class V>
inline V sqrt(V a) {
  V r;
  for (unsigned i = 0; i < sizeof(V) / sizeof(a[0]); ++i) {
    if constexpr (sizeof(a[0]) == 4) {
      r[i] = __builtin_sqrtf(a[i]);
    } else {
      r[i] = __builtin_sqrt(a[i]);
    }
  }
  return r;
}

#define GLISS_LANES_FORM(V, FMA, SQRT) \
  static_assert(sizeof(V) >= 16);      \
  template <>                          \
  inline V fma<V>(V a, V b, V c) {     \
    return FMA(a, b, c);               \
  }                                    \
  template <>                          \
  inline V sqrt<V>(V a) {              \
    return SQRT(a);                    \
  }

#ifdef __FMA__
GLISS_LANES_FORM(__m128, _mm_fmadd_ps, _mm_sqrt_ps)
GLISS_LANES_FORM(__m128d, _mm_fmadd_pd, _mm_sqrt_pd)
GLISS_LANES_FORM(__m256, _mm256_fmadd_ps, _mm256_sqrt_ps)
GLISS_LANES_FORM(__m256d, _mm256_fmadd_pd, _mm256_sqrt_pd)
#endif
#ifdef __AVX512F__
GLISS_LANES_FORM(__m512, _mm512_fmadd_ps, _mm512_sqrt_ps)
GLISS_LANES_FORM(__m512d, _mm512_fmadd_pd, _mm512_sqrt_pd)
#endif
#undef GLISS_LANES_FORM

// True if a comparison holds in any lane.
template <class Mask>
inline bool any(Mask mask) {
  unsigned long long parts[sizeof(Mask) / 8], sum = 0;
  __builtin_memcpy(parts, &mask, sizeof mask);
  for (const unsigned long long part : parts) sum |= part;
  return sum != 0;
}

// Lane by lane a bit: 1 where a comparison holds.
template <class Mask>
inline unsigned long bits(Mask mask) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof mask == 64)
    return sizeof(mask[0]) == 8 ? _mm512_movepi64_mask((__m512i)mask)
                                : _mm512_movepi32_mask((__m512i)mask);
#endif
#if defined(__AVX2__)
  if constexpr (sizeof mask == 32)
    return static_cast<unsigned long>(sizeof(mask[0]) == 8 ? _mm256_movemask_pd((__m256d)mask)
                                                           : _mm256_movemask_ps((__m256)mask));
#endif
  unsigned long r = 0;
  for (unsigned i = 0; i < sizeof(Mask) / sizeof(mask[0]); ++i)
    r |= static_cast<unsigned long>(mask[i] & 1) << i;
  return r;
}

// Rows and columns swapped: `rows` has as many vectors as a vector has numbers.
template <unsigned kStep, class V, std::size_t... kJ>
inline void exchange(V& a, V& b, std::index_sequence<kJ...>) {
  constexpr std::size_t kCount = sizeof...(kJ);
#if defined(__has_builtin) && __has_builtin(__builtin_shufflevector)
  const V low = __builtin_shufflevector(a, b, (kJ & kStep ? kCount + (kJ ^ kStep) : kJ)...);
  b = __builtin_shufflevector(a, b, (kJ & kStep ? kCount + kJ : kJ | kStep)...);
#else
  using Index = decltype(V{} < V{});
  const V low = __builtin_shuffle(a, b, Index{(kJ & kStep ? kCount + (kJ ^ kStep) : kJ)...});
  b = __builtin_shuffle(a, b, Index{(kJ & kStep ? kCount + kJ : kJ | kStep)...});
#endif
  a = low;
}
template <unsigned kStep = 1, class V>
inline void transpose(V* rows) {
  constexpr std::size_t kCount = sizeof(V) / sizeof(rows[0][0]);
  if constexpr (kStep < kCount) {
    for (std::size_t i = 0; i < kCount; ++i) {
      if (!(i & kStep))
        exchange<kStep>(rows[i], rows[i | kStep], std::make_index_sequence<kCount>());
    }
    transpose<2 * kStep>(rows);
  }
}

// Reads `count` numbers of each lane, as many as lanes at least, number i of all into to[i];
// store_columns writes them back.
template <class V, class Scalar>
inline void load_columns(const Scalar* const* from, std::size_t count, V* to) {
  constexpr std::size_t kLanes = sizeof(V) / sizeof(Scalar);
  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    // The last rows overlap those before, not to read beyond the end.
    const std::size_t first = begin + kLanes > count ? count - kLanes : begin;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      V row;  // from memory to memory, GCC copies word by word
      __builtin_memcpy(&row, from[lane] + first, sizeof row);
      to[first + lane] = row;
    }
    transpose(to + first);
  }
}
template <class V, class Scalar>
inline void store_columns(const V* from, std::size_t count, Scalar* const* to) {
  constexpr std::size_t kLanes = sizeof(V) / sizeof(Scalar);
  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    const std::size_t first = begin + kLanes > count ? count - kLanes : begin;
    V rows[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) rows[i] = from[first + i];
    transpose(rows);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const V row = rows[lane];
      __builtin_memcpy(to[lane] + first, &row, sizeof row);
    }
  }
}

}  // namespace gliss::lanes
