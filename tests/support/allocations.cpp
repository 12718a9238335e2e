#include "tests/support/allocations.h"

#include <errno.h>
#include <stddef.h>

namespace {

thread_local std::uint64_t counted = 0;
thread_local std::uint64_t first_failing = 0;  // of those counted; 0: none
thread_local bool lasting_failure = false;

// Counts a call; true if it must fail.
[[maybe_unused]] bool fails() {
  ++counted;
  const bool now = counted == first_failing || (lasting_failure && counted > first_failing);
  if (first_failing == 0 || !now) return false;
  errno = ENOMEM;
  return true;
}

}  // namespace

namespace gliss::test {

FailingAllocation::FailingAllocation(std::uint64_t k, bool lasting) noexcept {
  first_failing = counted + k;
  lasting_failure = lasting;
}

void FailingAllocation::end() noexcept {
  if (first_failing == 0) return;
  has_failed_ = counted >= first_failing;
  first_failing = 0;
}

}  // namespace gliss::test

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// glibc lets a program have its own, and keeps these names for what they were.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) { return fails() ? nullptr : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return fails() ? nullptr : __libc_calloc(count, size); }
void* realloc(void* block, size_t size) { return fails() ? nullptr : __libc_realloc(block, size); }
void* memalign(size_t alignment, size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, size_t alignment, size_t size) {
  *block = memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}

bool gliss::test::allocations_are_counted() noexcept { return true; }
#else
bool gliss::test::allocations_are_counted() noexcept { return false; }
#endif

std::uint64_t gliss::test::allocations() noexcept { return counted; }
