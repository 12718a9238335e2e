// Arrays of a whole surface. Where they are large they lie in huge pages, if the system has them: a
// million patches are half a million small pages, which a build or a load would take one by one,
// and searches would look up. Numbers that resize() adds have no value yet: their pages come to the
// threads that fill them.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace gliss {

template <class T>
struct HugePages {
  using value_type = T;
  static constexpr std::size_t kPage = std::size_t{1} << 21, kLarge = 4 * kPage;  // bytes

  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) {}

  T* allocate(std::size_t count) {
    if (!is_large(count)) return std::allocator<T>().allocate(count);
    const std::size_t bytes = count * sizeof(T);
    void* memory = ::operator new (bytes, std::align_val_t{kPage});
    madvise(memory, bytes, MADV_HUGEPAGE);  // advice: small pages do as well
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) {
    if (!is_large(count)) return std::allocator<T>().deallocate(memory, count);
    ::operator delete (memory, std::align_val_t{kPage});
  }
  // Makes an element that resize() adds.
  template <class U>
  void construct(U* element) {
    ::new (static_cast<void*>(element)) U;
  }
  template <class U>
  bool operator==(const HugePages<U>&) const {
    return true;
  }

 private:
  static bool is_large(std::size_t count) { return count >= kLarge / sizeof(T); }
};

template <class T>
using LargeArray = std::vector<T, HugePages<T>>;

// A large array whose copies share its memory until one of them is written.
template <class T>
class SharedArray {
 public:
  const LargeArray<T>& read() const {
    static const LargeArray<T> none;
    return array_ ? *array_ : none;
  }
  // The array, to be written: copies keep theirs. Not while another thread copies this one.
  LargeArray<T>& write() {
    if (!array_ || array_.use_count() > 1) array_ = std::make_shared<LargeArray<T>>(read());
    return *array_;
  }
  bool empty() const { return read().empty(); }
  std::size_t size() const { return read().size(); }
  const T& operator[](std::size_t i) const { return read()[i]; }
  auto begin() const { return read().begin(); }
  auto end() const { return read().end(); }
  bool operator==(const SharedArray& other) const { return read() == other.read(); }

 private:
  std::shared_ptr<LargeArray<T>> array_;
};

}  // namespace gliss
