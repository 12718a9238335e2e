// Seqlock with a writer and two readers, for ThreadSanitizer, which ends the program with 66 where
// it finds a race; 1 where a value is torn.
#include <cstdio>
#include <thread>

#include "gliss/thread/seqlock.h"

namespace {

using Words = std::array<std::uint64_t, 64>;

constexpr std::uint64_t kStores = 100'000;

}  // namespace

int main() {
  gliss::Seqlock<Words> lock;
  std::atomic<std::uint64_t> torn{0}, loaded{0};
  std::atomic<bool> stop{false};
  const auto read = [&] {
    while (!stop) {
      const auto sample = lock.load();
      if (!sample) continue;
      ++loaded;
      for (const std::uint64_t word : sample->value)
        if (word != sample->number) ++torn;
    }
  };
  std::thread first(read), second(read);
  for (std::uint64_t n = 1; n <= kStores || loaded == 0; ++n) {
    Words words;
    words.fill(n);
    lock.store(words);
    if (n % 16 == 0) std::this_thread::yield();
  }
  stop = true;
  first.join();
  second.join();
  std::printf("%llu loads, %llu torn words\n", static_cast<unsigned long long>(loaded),
              static_cast<unsigned long long>(torn));
  return torn == 0 ? 0 : 1;
}
