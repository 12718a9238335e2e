// Counts how often a thread asks for memory, for what may not; and memory that it does not get.
#pragma once

#include <cstdint>

namespace gliss::test {

// Calls of malloc, calloc, realloc and their aligned kin by this thread so far, operator new's too;
// always 0 where a sanitizer has taken their place.
std::uint64_t allocations() noexcept;
bool allocations_are_counted() noexcept;

// While it lives, the k-th of these calls by this thread fails, and if `lasting` all that follow.
class FailingAllocation {
 public:
  FailingAllocation(std::uint64_t k, bool lasting) noexcept;
  ~FailingAllocation() { end(); }
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  void end() noexcept;
  bool has_failed() const noexcept { return has_failed_; }  // by the end

 private:
  bool has_failed_ = false;
};

}  // namespace gliss::test
