// The bridge: what each language calls its numbers. Included first, inside the namespace of its
// instance. The includer defines GLISS_SCALAR (float or double) and GLISS_LANES (1, or the number
// of samples a `real` holds: load_lanes and store_lanes move that many neighbours of an array,
// `lane` reads one, `gather` each one's own number of an array; `uints` are as many whole numbers,
// which `reals_of` makes reals below 2^31; a `mask` holds what a comparison of
// two says, and masks meet in &, | and `without`), and in C++ GLISS_PACKED where the samples are of
// as many patches. Only + - * / sqrt fma and comparisons are used: IEEE gives them the same bits in
// every language.

typedef GLISS_SCALAR scalar;

// EVALUATES and PROMISE are for a build of the tests that counts and checks (tests/counting), and
// nothing in all others.
#ifndef EVALUATES
#define EVALUATES
#define PROMISE(holds)
#endif

#ifdef __OPENCL_C_VERSION__

#pragma OPENCL FP_CONTRACT OFF
#define GLISS_JOIN_(a, b) a##b
#define GLISS_JOIN(a, b) GLISS_JOIN_(a, b)
#if GLISS_LANES == 1
typedef scalar real;
typedef int mask;
#define any(m) (m)
typedef uint uints;
#define bits_of(m) ((ulong)((m) != 0))
#define reals_of(u) ((real)(int)(u))
#define load_uints(at) (*(at))
#define without(a, b) ((a) & !(b))
#define pick(condition, a, b) ((condition) ? (a) : (b))
#else
typedef GLISS_JOIN(GLISS_SCALAR, GLISS_LANES) real;
#define GLISS_MASK_float int
#define GLISS_MASK_double long
typedef GLISS_JOIN(GLISS_JOIN(GLISS_MASK_, GLISS_SCALAR), GLISS_LANES) mask;
#define without(a, b) ((a) & ~(b))
#define pick(condition, a, b) select((real)(b), (real)(a), condition)
#endif
#define splat(s) ((real)(s))
#if GLISS_LANES == 1
#define load_lanes(at) (*(at))
#define store_lanes(at, value) (*(at) = (value))
#define lane(value, i) (value)
#define gather(at, index) ((at)[(int)(index)])
#else
#define load_lanes(at) GLISS_JOIN(vload, GLISS_LANES)(0, at)
#define store_lanes(at, value) GLISS_JOIN(vstore, GLISS_LANES)(value, 0, at)
#define lane(value, i) (((const scalar*)&(value))[i])
#endif
#define lowest_bit(x) ((int)popcount(((x) & -(x)) - 1))
#define GLOBAL __global const
#define GLOBAL_OUT __global
// A GPU's driver would inline large functions, and takes minutes to compile what comes of that.
#ifndef GLISS_LARGE
#define GLISS_LARGE __attribute__((noinline))
#endif
#define FN_LARGE static GLISS_LARGE
#define FN_APART FN_LARGE
#define FN_ONCE FN
// PoCL does not inline by itself what takes structs of vectors; Oclgrind cannot read what inlining
// leaves behind, and defines this as nothing.
#ifndef GLISS_INLINE
#define GLISS_INLINE __attribute__((always_inline))
#endif
#define FN static inline GLISS_INLINE
#if GLISS_LANES > 1
FN real gather(GLOBAL scalar* at, real index) {
  real r;
  for (int i = 0; i < GLISS_LANES; ++i) ((scalar*)&r)[i] = at[(int)lane(index, i)];
  return r;
}
#endif

#else  // C++

#define GLOBAL const
#define GLOBAL_OUT
#define FN_LARGE static __attribute__((unused))
// Large and called from one place: in OpenCL, part of what calls it.
#define FN_ONCE FN_LARGE
// Never inlined: what calls it now and then keeps its registers for what it does always.
#define FN_APART static __attribute__((noinline, unused))
#define FN static inline __attribute__((always_inline, unused))
typedef unsigned int uint;
typedef unsigned long ulong;
FN int lowest_bit(ulong x) { return __builtin_ctzl(x); }
#if GLISS_LANES == 1
typedef scalar real;
typedef bool mask;
typedef uint uints;
FN ulong bits_of(mask m) { return m; }
FN real reals_of(uints u) { return (real)(int)u; }
FN uints load_uints(const uint* at) { return *at; }
FN bool any(mask m) { return m; }
FN mask without(mask a, mask b) { return a && !b; }
FN real fma(real a, real b, real c) {
  return sizeof(real) == 4 ? (real)__builtin_fmaf((float)a, (float)b, (float)c)
                           : (real)__builtin_fma((double)a, (double)b, (double)c);
}
FN real sqrt(real a) {
  return sizeof(real) == 4 ? (real)__builtin_sqrtf((float)a) : (real)__builtin_sqrt((double)a);
}
FN real fabs(real a) { return a < 0 ? -a : a; }
FN real splat(scalar s) { return s; }
FN real load_lanes(const scalar* at) { return *at; }
FN void store_lanes(scalar* at, real value) { *at = value; }
FN scalar lane(real value, int) { return value; }
FN real gather(const scalar* at, real index) { return at[(int)index]; }
#else
typedef scalar real __attribute__((vector_size(GLISS_LANES * sizeof(GLISS_SCALAR))));
typedef decltype(real{} < real{}) mask;
typedef uint uints __attribute__((vector_size(GLISS_LANES * sizeof(uint))));
FN ulong bits_of(mask m) { return gliss::lanes::bits(m); }
FN real reals_of(uints u) {
  typedef int ints __attribute__((vector_size(GLISS_LANES * sizeof(int))));
  return __builtin_convertvector((ints)u, real);
}
FN uints load_uints(const uint* at) {
  uints r;
  __builtin_memcpy(&r, at, sizeof r);
  return r;
}
FN bool any(mask m) { return gliss::lanes::any(m); }
FN mask without(mask a, mask b) { return a & ~b; }
FN real fma(real a, real b, real c) { return gliss::lanes::fma(a, b, c); }
FN real sqrt(real a) { return gliss::lanes::sqrt(a); }
FN real fabs(real a) { return a < 0 ? -a : a; }
FN real splat(scalar s) { return s - (real){}; }
FN real load_lanes(const scalar* at) {
  real r;
  __builtin_memcpy(&r, at, sizeof r);
  return r;
}
FN void store_lanes(scalar* at, real value) { __builtin_memcpy(at, &value, sizeof value); }
FN scalar lane(real value, int i) { return value[i]; }
FN real gather(const scalar* at, real index) {
  real r = {};
  for (int i = 0; i < GLISS_LANES; ++i) r[i] = at[(int)index[i]];
  return r;
}
#endif
#define pick(condition, a, b) ((condition) ? (a) : (b))

#endif

// The control data of a patch, which all lanes share; packed, each lane has its own of every
// number.
#ifdef GLISS_PACKED
typedef const real* control_data;
typedef real* control_out;
FN real number_at(control_data at, int i) { return at[i]; }
#else
typedef GLOBAL scalar* control_data;
typedef GLOBAL_OUT scalar* control_out;
FN real number_at(control_data at, int i) { return splat(at[i]); }
#endif

// Loops over the sides are unrolled where the valence is a constant; not where every fma is a call,
// which only takes the compiler minutes.
#if defined(__x86_64__) && !defined(__FMA__) && !defined(__OPENCL_C_VERSION__)
#define UNROLL_UP_TO(n)
#elif defined(__clang__)
#define GLISS_PRAGMA(x) _Pragma(#x)
#define UNROLL_UP_TO(n) GLISS_PRAGMA(unroll n)
#else
#define GLISS_PRAGMA(x) _Pragma(#x)
#define UNROLL_UP_TO(n) GLISS_PRAGMA(GCC unroll n)
#endif
#define UNROLL UNROLL_UP_TO(6)

// A constant of the instance's own type: no double sneaks into float code.
#define K(x) ((scalar)(x))

FN real larger(real a, real b) { return pick(a > b, a, b); }
FN real smaller(real a, real b) { return pick(a < b, a, b); }

// Largest whole number not above x, |x| < 2^22.
FN real whole_part(real x) {
  const real big = splat(sizeof(scalar) == 4 ? K(0x1p23f) : K(0x1p52f)), near = (x + big) - big;
  return pick(near > x, near - K(1), near);
}

// Distance from 1 to the next number.
#define EPSILON (sizeof(scalar) == 4 ? K(0x1p-23f) : K(0x1p-52f))

// Keeps quotients finite where numerator and denominator vanish together: such terms carry a weight
// of zero.
#define TINY (sizeof(scalar) == 4 ? K(1e-18f) : (scalar)1e-18f * (scalar)1e-18f)
