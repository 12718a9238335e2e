// The number of operations that the formulas need, counted as the kernels' own text runs.
#pragma once

#include <cstdint>

namespace gliss::bench {

// Counts the flops of a position with both derivatives: an fma is two, every other + - * / sqrt
// one; choices and signs are free. What is asked for twice counts once, and what is the same for
// all points of a patch not at all.
double flops_of_evaluate(std::uint32_t form, std::uint32_t n);
// Counts the flops of the control data of a patch.
double flops_of_build(std::uint32_t n);

}  // namespace gliss::bench
