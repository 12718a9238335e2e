// What is loaded was stored in one piece, and the numbers never go back: 1e6 loads while a thread
// stores, 1e8 with GLISS_LONG_TESTS.
#include "gliss/thread/seqlock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <thread>
#include <vector>

#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using Words = std::array<std::uint64_t, 64>;

Words equal_words(std::uint64_t value) {
  Words words;
  words.fill(value);
  return words;
}

std::uint64_t loads() { return std::getenv("GLISS_LONG_TESTS") ? 100'000'000 : 1'000'000; }

struct Tally {
  std::uint64_t loaded = 0, torn = 0, back = 0, misnumbered = 0, fresh = 0, nothing = 0;
};

// The n-th value stored is n in all its words. What met 16 writes running is no load.
Tally judge(const Seqlock<Words>& lock, std::uint64_t count) {
  Tally tally;
  std::uint64_t same = 0;
  for (std::uint64_t last = 0; tally.loaded < count || tally.fresh < 100;) {
    const auto sample = lock.load();
    same = sample && sample->number == last ? same + 1 : 0;
    // The two may share a core, and the writer be stopped in the midst of a value.
    if (!sample || same % 4096 == 4095) std::this_thread::yield();
    if (!sample) {
      ++tally.nothing;
      continue;
    }
    const Words& words = sample->value;
    ++tally.loaded;
    if (std::any_of(words.begin(), words.end(), [&](auto word) { return word != words[0]; }))
      ++tally.torn;
    if (words[0] != sample->number) ++tally.misnumbered;
    if (sample->number < last) ++tally.back;
    if (sample->number > last) ++tally.fresh;
    last = sample->number;
  }
  return tally;
}

void expect_whole_values(int readers) {
  Seqlock<Words> lock;
  lock.store(equal_words(1));
  std::atomic<bool> stop{false};
  std::thread writer([&] {
    for (std::uint64_t n = 2; !stop; ++n) {
      lock.store(equal_words(n));
      // Else a reader would hardly ever meet no write.
      for (int i = 0; i < 200; ++i) std::atomic_signal_fence(std::memory_order_seq_cst);
    }
  });
  std::vector<Tally> tallies(static_cast<std::size_t>(readers));
  std::vector<std::thread> threads;
  for (Tally& tally : tallies) threads.emplace_back([&] { tally = judge(lock, loads()); });
  for (std::thread& thread : threads) thread.join();
  stop = true;
  writer.join();
  for (const Tally& tally : tallies) {
    EXPECT_EQ(tally.torn, 0u);
    EXPECT_EQ(tally.back, 0u);
    EXPECT_EQ(tally.misnumbered, 0u);
    test::record("loads", "{}, of {} values, {} met writes only", tally.loaded, tally.fresh,
                 tally.nothing);
  }
}

TEST(Seqlock, one_reader_never_sees_a_torn_value) { expect_whole_values(1); }
TEST(Seqlock, two_readers_never_see_a_torn_value) { expect_whole_values(2); }

TEST(Seqlock, has_nothing_before_the_first_store_and_numbers_from_1) {
  Seqlock<Words> lock;
  EXPECT_FALSE(lock.load());
  for (std::uint64_t n = 1; n <= 3; ++n) {
    lock.store(equal_words(7 * n));
    const auto sample = lock.load(1);
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->number, n);
    EXPECT_EQ(sample->value, equal_words(7 * n));
  }
}

TEST(Seqlock, keeps_what_does_not_fill_its_last_word) {
  struct Odd {
    char text[11];
  };
  Seqlock<Odd> lock;
  lock.store({"0123456789"});
  EXPECT_STREQ(lock.load()->value.text, "0123456789");
}

}  // namespace
}  // namespace gliss
