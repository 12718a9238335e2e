// A build of the kernels that counts evaluations where they are made, whatever account is kept of
// them, and checks what functions promise each other (EVALUATES and PROMISE of kernels/real.h).
#pragma once

#include <cstdint>

namespace gliss::counting {

struct Counts {
  std::int64_t evaluations = 0;  // calls of evaluate_form
  std::int64_t told = 0;         // evaluations as the contacts of the kernels tell them
  std::int64_t iterations = 0;   // those and one more, of each contact
};
inline Counts counts;
inline std::int64_t broken = 0;  // promises that did not hold

// Tells of the first few.
void break_promise(const char* promise, const char* file, int line);

}  // namespace gliss::counting
