// How often a thread asks for memory, for what may not.
#pragma once

#include <cstdint>

namespace gliss::test {

// Calls of malloc, calloc, realloc and their aligned kin by this thread so far, operator new's too;
// always 0 where a sanitizer has taken their place.
std::uint64_t allocations() noexcept;
bool allocations_are_counted() noexcept;

}  // namespace gliss::test
