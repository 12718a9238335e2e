// A set of numbered things of which equal ones are to be found: open addressing, 4 bytes a slot.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gliss/base/vector.h"

namespace gliss {

// Mixes all bits of a 64-bit number (the finaliser of SplitMix64, Steele et al. 2014).
inline std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

// The same of a point; 0 and -0 are one.
inline std::uint64_t mix_bits(const Vec3& point) {
  std::uint64_t hash = 0;
  for (const double x : point) hash = mix_bits(hash ^ std::bit_cast<std::uint64_t>(x + 0.0));
  return hash;
}

class HashIndex {
 public:
  explicit HashIndex(std::size_t capacity) {
    std::size_t size = 16;
    while (size < 2 * capacity) size *= 2;
    slots_.assign(size, kNone);
  }

  // The first item that equals this one; the item itself, now held, where there is none.
  template <class Equal>
  std::uint32_t find_or_insert(std::uint32_t item, std::uint64_t hash, Equal equal) {
    for (std::size_t i = hash & (slots_.size() - 1);; i = (i + 1) & (slots_.size() - 1)) {
      if (slots_[i] == kNone) return slots_[i] = item;
      if (equal(slots_[i], item)) return slots_[i];
    }
  }

 private:
  std::vector<std::uint32_t> slots_;
};

}  // namespace gliss
