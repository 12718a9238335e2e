// The timer: deadlines on a grid, what is missed is skipped. Nothing here asks how fast the machine
// is: what it does is compared with the clock's own readings.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "gliss/thread/timing.h"
#include "tests/support/allocations.h"
#include "tests/support/surfaces.h"
#include "tests/thread/locked_memory.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kPeriod = 1ms;

struct GridCase {
  const char* what;
  Nanoseconds woke, now;  // after the deadline at 0
  std::uint64_t missed;
};

TEST(Periodic, skips_what_is_over_and_what_is_too_soon) {
  for (const auto& [what, woke, now, missed] :
       std::vector<GridCase>{{"in time", 20us, 100us, 0},
                             {"computes to the next deadline", 20us, 1ms, 0},
                             {"... and past it", 20us, 1ms + 1ns, 1},
                             {"stalls for 7 ms", 20us, 7ms + 20us, 7},
                             {"... nearly 8", 20us, 8ms, 7},
                             {"wakes half a period late", 500us, 510us, 0},
                             {"... and more: the next would follow too soon", 501us, 510us, 1},
                             {"wakes 3.4 ms late", 3400us, 3410us, 3},
                             {"wakes 3.6 ms late", 3600us, 3610us, 4},
                             {"stands still for a day", 24h, 24h + 1us, 86400000}}) {
    SCOPED_TRACE(what);
    const Nanoseconds start = 12345us;
    DeadlineGrid grid(start, kPeriod);
    EXPECT_EQ(grid.advance(start + woke, start + now), missed);
    const Nanoseconds expected = static_cast<std::int64_t>(missed + 1) * kPeriod;
    EXPECT_EQ((grid.deadline() - start).count(), expected.count());
    EXPECT_GE(grid.deadline(), start + now);
    EXPECT_GE(grid.deadline() - (start + woke), kPeriod / 2);
  }
}

TEST(Periodic, refuses_a_period_that_would_spin_or_never_end) {
  for (const Nanoseconds period :
       {Nanoseconds(-1ms), Nanoseconds(0ns), Nanoseconds(9999ns), Nanoseconds(1s + 1ns)}) {
    EXPECT_THROW(PeriodicTimer timer(period), std::invalid_argument) << period.count();
  }
}

// Expects what holds of every two wakes, however late the machine.
void expect_on_grid(const Wake& before, const Wake& after) {
  EXPECT_EQ((after.deadline - before.deadline).count(),
            (static_cast<std::int64_t>(after.missed + 1) * kPeriod).count());
  EXPECT_GE(after.lateness.count(), 0);
  const Nanoseconds apart = after.deadline + after.lateness - before.deadline - before.lateness;
  EXPECT_GE(apart.count(), (kPeriod / 2).count());
}

TEST(Periodic, a_stall_of_7_ms_misses_7_cycles_and_stays_on_the_grid) {
  PeriodicTimer timer(kPeriod);
  Wake before = timer.wait();
  int judged = 0, exact = 0;
  for (int round = 0; round < 20; ++round) {
    for (int i = 0; i < 5; ++i) {
      const Wake wake = timer.wait();
      expect_on_grid(before, wake);
      before = wake;
    }
    std::this_thread::sleep_for(before.deadline + 7100us - monotonic_time());
    const Nanoseconds stalled = monotonic_time() - before.deadline;
    const Wake wake = timer.wait();
    expect_on_grid(before, wake);
    EXPECT_GE(wake.missed, 7u);
    // Pre-empted before it read its clock, the timer rightly finds more.
    if (stalled < 7800us) {
      ++judged;
      exact += wake.missed == 7 ? 1 : 0;
    }
    before = wake;
  }
  EXPECT_GE(2 * exact, judged);
  test::record("stalls of 7 ms", "{} of {} missed 7", exact, judged);
}

std::atomic<int> signals_caught{0};

TEST(Periodic, survives_signals) {
  struct sigaction quiet {
  }, old{};
  quiet.sa_handler = [](int) { ++signals_caught; };
  const int before_all = signals_caught;
  sigaction(SIGUSR1, &quiet, &old);
  std::atomic<bool> stop{false};
  const pthread_t target = pthread_self();
  std::thread pest([&] {
    while (!stop) {
      pthread_kill(target, SIGUSR1);
      std::this_thread::sleep_for(100us);
    }
  });
  PeriodicTimer timer(kPeriod);
  Wake before = timer.wait();
  for (int i = 0; i < 50; ++i) {
    const Wake wake = timer.wait();
    expect_on_grid(before, wake);
    before = wake;
  }
  stop = true;
  pest.join();
  sigaction(SIGUSR1, &old, nullptr);
  EXPECT_GT(signals_caught, before_all);
}

TEST(Periodic, sleeps_instead_of_spinning) {
  PeriodicTimer timer(kPeriod);
  const Nanoseconds wall = monotonic_time(), used = thread_time();
  for (int i = 0; i < 300; ++i) timer.wait();
  const double share = std::chrono::duration<double>(thread_time() - used) /
                       std::chrono::duration<double>(monotonic_time() - wall);
  EXPECT_LE(share, 0.6);
  test::record("share of a core", "{:.1f} %", 100 * share);
}

TEST(Periodic, a_hundred_thousand_ticks_allocate_nothing_and_fault_nothing_in) {
  constexpr int kTicks = 100000;
  const auto record = std::make_unique<TickRecord>();
  PeriodicTimer timer(PeriodicTimer::kShortest);
  const test::LockedMemory locked;
  const test::PageFaults before = test::PageFaults::now();
  const std::uint64_t allocated = test::allocations();
  std::uint64_t missed = 0;
  const Wake first = timer.wait();
  Wake wake = first;
  for (int i = 0; i < kTicks; ++i) {
    wake = timer.wait();
    missed += wake.missed;
    const Nanoseconds start = thread_time();
    record->add({wake.lateness, thread_time() - start, 0}, wake.missed);
  }
  EXPECT_EQ(test::allocations(), allocated);
  const test::PageFaults faults = test::PageFaults::now() - before;
  EXPECT_EQ(faults.major, 0);
  if (locked.is_granted()) {
    EXPECT_EQ(faults.minor, 0);
  }
  EXPECT_EQ(record->ticks(), std::uint64_t{kTicks});
  EXPECT_EQ(record->missed(), missed);
  // Every period of the grid was a tick or was missed.
  EXPECT_EQ((wake.deadline - first.deadline) / PeriodicTimer::kShortest,
            static_cast<std::int64_t>(kTicks + missed));
  test::record("minor faults", "{}", faults.minor);
}

// The counter must count, or the test above says nothing.
TEST(Periodic, the_test_sees_allocations) {
  if (!test::allocations_are_counted()) GTEST_SKIP() << "a sanitizer has malloc";
  const std::uint64_t before = test::allocations();
  const auto block = std::make_unique<std::vector<int>>(1000);
  EXPECT_GE(test::allocations(), before + 2) << block->size();
}

}  // namespace
}  // namespace gliss
