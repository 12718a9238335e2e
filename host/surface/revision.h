// The revision of the numbers.
#pragma once

#include <cstdint>

namespace gliss {

// Raised where the same mesh gets other numbers than before: in a cache, or in a contact. Caches
// and parts of sweeps of another revision are stale; those of another release are not. The test
// Revision tells when.
inline constexpr std::uint32_t kNumbersRevision = 14;

}  // namespace gliss
