// Replaces operator new and delete of a program: large blocks lie in huge pages, if the system has
// them, as a LargeArray does. A mesh of a million faces is read into vectors that grow, and checked
// with others; in small pages that takes half as long again.
#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

#include "gliss/base/large_array.h"

namespace {

constexpr std::size_t kPage = gliss::HugePages<char>::kPage;

void* allocate(std::size_t bytes) {
  if (bytes < kPage) return std::malloc(bytes > 0 ? bytes : 1);
  void* const memory = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
  if (memory != nullptr) madvise(memory, bytes, MADV_HUGEPAGE);  // advice: small pages do as well
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) {
  for (;;) {
    if (void* const memory = allocate(bytes)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
