// The latest value of one writer for any number of readers, neither of whom ever waits for the
// other to be scheduled for long: the writer not at all, a reader until it meets no write
// (H.-J. Boehm, Can seqlocks get along with programming language memory models?, 2012).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace gliss {

template <class T>
class Seqlock {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  struct Sample {
    T value;
    std::uint64_t number;  // 1 for the first value stored
  };

  // One thread only. A reader that sees a word of this value also sees an odd or a later count.
  void store(const T& value) noexcept {
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof value);
    const std::uint64_t count = count_.load(std::memory_order_relaxed);
    count_.store(count + 1, std::memory_order_relaxed);
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    count_.store(count + 2, std::memory_order_release);
  }

  // Nothing where nothing was stored yet, or where each of `tries` met a write.
  std::optional<Sample> load(int tries = 16) const noexcept {
    for (; tries > 0; --tries) {
      const std::uint64_t before = count_.load(std::memory_order_acquire);
      if (before == 0) return std::nullopt;
      std::array<std::uint64_t, kWords> words;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (before % 2 == 0 && before == count_.load(std::memory_order_relaxed)) {
        Sample sample;
        std::memcpy(&sample.value, words.data(), sizeof sample.value);
        sample.number = before / 2;
        return sample;
      }
    }
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  alignas(64) std::atomic<std::uint64_t> count_{0};  // odd while a value is being stored
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace gliss
