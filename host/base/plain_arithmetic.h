// The arithmetic that results are the same bytes in: round to nearest, keep denormals, and go on
// where a quotient or a comparison is of no number.
#pragma once

#include <cfenv>

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace gliss {

// Sets it for as long as it lives, where the thread has another (fesetround, -ffast-math's flush to
// zero, feenableexcept's signals), and then that again. Where there is nothing to do it takes a
// nanosecond.
class PlainArithmetic {
 public:
  PlainArithmetic() noexcept : is_plain_(is_plain()) {
    if (is_plain_) return;
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~PlainArithmetic() {
    if (!is_plain_) std::fesetenv(&before_);
  }
  PlainArithmetic(const PlainArithmetic&) = delete;
  PlainArithmetic& operator=(const PlainArithmetic&) = delete;

 private:
  static bool is_plain() noexcept {
#if defined(__x86_64__)
    constexpr unsigned kRounding = 0x6000, kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040,
                       kNoSignals = 0x1f80;
    return (_mm_getcsr() & (kRounding | kFlushToZero | kDenormalsAreZero | kNoSignals)) ==
           kNoSignals;
#elif defined(__GLIBC__)
    return std::fegetround() == FE_TONEAREST && fegetexcept() == 0;
#else
    return false;  // who may signal is not known
#endif
  }

  const bool is_plain_;
  std::fenv_t before_;
};

}  // namespace gliss
