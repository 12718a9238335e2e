// Haptic loop and haptic device in two processes, one of which is killed or stands still. Judged by
// the times that the ticks themselves have read, however late the machine: a tick of the device
// whose last datagram is more than 20 ms old has no force, nor has one of the loop whose last
// state is more than 10 ms old.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "gliss/device/guard.h"
#include "gliss/device/udp_device.h"
#include "gliss/device/udp_server.h"
#include "gliss/thread/periodic.h"
#include "tests/device/udp_fakes.h"
#include "tests/support/gliss_process.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kKillPatience = 60s;  // a machine may be that slow
constexpr Nanoseconds kFresh = 20ms;
constexpr Nanoseconds kAfter = 60ms;  // what is watched after the end
constexpr std::uint64_t kEntries = 200'000;

// A log of what one process does in its ticks, for another to read.
struct Log {
  struct Entry {
    Nanoseconds now;
    Vec3 force;
  };
  void add(Nanoseconds now, const Vec3& force) {
    const std::uint64_t i = count.load();
    if (i == kEntries) _exit(1);
    entries[i] = {now, force};
    count = i + 1;
  }
  std::uint64_t size() const { return count.load(); }
  Entry last() const { return size() == 0 ? Entry{} : entries[size() - 1]; }

  std::atomic<std::uint64_t> count;
  Entry entries[kEntries];
};

struct Shared {
  Log loop, device;
  std::atomic<std::uint16_t> port;
  std::atomic<bool> stop;
};

// A force along x that tells which entry of the loop's log it is; none is exactly none.
Vec3 numbered(double force, std::uint64_t entry) {
  return force == 0 ? Vec3::Zero() : Vec3(force, 0, 1e-6 * static_cast<double>(entry));
}
std::uint64_t entry_of(const Vec3& force) {
  return static_cast<std::uint64_t>(std::llround(force.z() * 1e6));
}

class Child {
 public:
  template <class Act>
  explicit Child(Act act) : pid_(fork()) {
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
      act();
      _exit(0);
    } catch (...) {
      _exit(1);
    }
  }
  ~Child() {
    signal(SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  void signal(int number) const { kill(pid_, number); }
  // Returns when it stands still.
  void stop() const {
    signal(SIGSTOP);
    waitpid(pid_, nullptr, WUNTRACED);
  }

 private:
  pid_t pid_;
};

class LoggedDevice : public test::FakeDevice {
 public:
  explicit LoggedDevice(Log& log) : log_(log) {}
  bool write(const Vec3& force, Nanoseconds now) noexcept override {
    log_.add(now, force);
    return true;
  }

 private:
  Log& log_;
};

class UdpKill : public ::testing::Test {
 protected:
  UdpKill()
      : shared_(*static_cast<Shared*>(mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE,
                                           MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~UdpKill() override { munmap(&shared_, sizeof(Shared)); }

  void serve() {
    LoggedDevice device(shared_.device);
    UdpServer server(device, 0, {.guard = std::nullopt});
    shared_.port = server.port();
    server.run([&] { return shared_.stop.load(); });
  }
  // Pushes as hard as it may, without a guard.
  void push() {
    await([&] { return shared_.port != 0; });
    UdpDevice device(shared_.port, kKillPatience);
    PeriodicTimer timer(1ms);
    for (;;) {
      timer.wait();
      const Nanoseconds now = monotonic_time();
      device.read(now);
      const Vec3 force = numbered(2, shared_.loop.size());
      shared_.loop.add(now, force);
      device.write(force, now);
    }
  }

  template <class Condition>
  static void await(Condition condition) {
    if (!test::await(condition)) throw std::runtime_error("nothing came");
  }
  void await_force(std::uint64_t since) {
    await([&] { return shared_.device.size() > since && shared_.device.last().force.x() == 2; });
  }
  // Until the device has ticked long after the loop's last.
  void await_silence() {
    await([&] { return shared_.device.last().now > shared_.loop.last().now + kAfter; });
  }
  // No tick of the device had a force that was more than 20 ms old.
  void expect_fresh_forces() {
    std::uint64_t pushing = 0;
    for (std::uint64_t i = 0; i < shared_.device.size(); ++i) {
      const auto& [now, force] = shared_.device.entries[i];
      if (force == Vec3::Zero()) continue;
      const std::uint64_t entry = entry_of(force);
      ASSERT_LT(entry, shared_.loop.size());
      ASSERT_LE((now - shared_.loop.entries[entry].now).count(), Nanoseconds(kFresh).count());
      ++pushing;
    }
    EXPECT_GT(pushing, 0u);
  }
  // After the loop's last datagram, in those of the device's ticks that are `before`.
  void report_end(const char* name, std::uint64_t before) {
    const Nanoseconds end = shared_.loop.last().now;
    std::uint64_t i = before;
    while (i > 0 && shared_.device.entries[i - 1].force == Vec3::Zero()) --i;
    ASSERT_LT(i, before);
    const Nanoseconds zero = shared_.device.entries[i].now - end;
    test::record(name, "no force {:.2f} ms after the last datagram", 1e-6 * zero.count());
  }

  Shared& shared_;
};

TEST_F(UdpKill, a_killed_loop_leaves_no_force) {
  const Child device([&] { serve(); });
  const Child loop([&] { push(); });
  await_force(0);
  loop.signal(SIGKILL);
  await_silence();
  expect_fresh_forces();
  report_end("kill -9 of the loop", shared_.device.size());
}

TEST_F(UdpKill, a_loop_that_stands_still_leaves_no_force_and_may_go_on) {
  const Child device([&] { serve(); });
  const Child loop([&] { push(); });
  await_force(0);
  loop.stop();
  await_silence();
  const std::uint64_t before = shared_.device.size();
  report_end("SIGSTOP of the loop", before);
  EXPECT_EQ(shared_.device.last().force, Vec3::Zero());
  loop.signal(SIGCONT);
  await_force(before);
  shared_.stop = true;
  expect_fresh_forces();
}

// A loop in this process, with its guard.
struct GuardedLoop {
  struct Tick {
    Nanoseconds now;
    DeviceState state;
    GuardOutput out;
    bool written;
  };

  // Wants 2 N wherever the guard lets it.
  const Tick& tick() {
    timer.wait();
    Tick t;
    t.now = monotonic_time();
    t.state = device.read(t.now);
    if (t.state.fault || !reached) guard.trip(GuardReason::kDeviceFault);
    if (t.state.fault || !reached) ++faults;
    const bool safe = guarded.state == GuardState::kSafe || guarded.state == GuardState::kStart;
    t.out = guarded = guard.step(t.now, {Vec3(safe ? 0 : 2, 0, 0), t.state.measured});
    const Vec3 force = numbered(t.out.force.x(), log.size());
    log.add(t.now, force);
    t.written = reached = device.write(force, t.now);
    ticks.push_back(t);
    return ticks.back();
  }
  // A machine that is late leads into kSafe too, and has to be led out of it.
  void push() {
    const Nanoseconds start = monotonic_time();
    while (tick().out.force.x() < 1.5) {
      if (guarded.state == GuardState::kSafe) guard.engage();
      if (monotonic_time() - start > kKillPatience)
        throw std::runtime_error("the force never came");
    }
  }
  // No tick had a force whose position was 10 ms old, or older.
  void expect_guarded() const {
    for (const Tick& t : ticks) {
      if (t.now - t.state.measured < 10ms) continue;
      ASSERT_EQ(t.out.force, Vec3::Zero()) << 1e-6 * (t.now - t.state.measured).count();
    }
  }
  void report_end(const char* name) const {
    std::size_t i = ticks.size();
    while (i > 0 && ticks[i - 1].out.force == Vec3::Zero()) --i;
    ASSERT_LT(i, ticks.size());
    test::record(name, "no force {:.2f} ms after the last state was measured, {}",
                 1e-6 * (ticks[i].now - ticks[i].state.measured).count(),
                 guard_reason_name(guarded.reason));
  }

  UdpDevice& device;
  Log& log;
  Guard guard{};
  GuardOutput guarded{};
  bool reached = true;
  int faults = 0;
  PeriodicTimer timer{1ms};
  std::vector<Tick> ticks{};
};

TEST_F(UdpKill, a_killed_device_is_a_fault_and_ends_the_force) {
  const Child server([&] { serve(); });
  await([&] { return shared_.port != 0; });
  UdpDevice device(shared_.port, kKillPatience);
  GuardedLoop loop{device, shared_.loop};
  loop.push();
  server.signal(SIGKILL);
  const Nanoseconds start = monotonic_time();
  while (loop.tick().written || loop.guarded.state != GuardState::kSafe) {
    ASSERT_LT(monotonic_time() - start, kKillPatience);
  }
  loop.expect_guarded();
  loop.report_end("kill -9 of the device");
  EXPECT_FALSE(loop.ticks.back().state.fault);
  // It is the one or the other, as the loop itself was late or not.
  EXPECT_TRUE(loop.guarded.reason == GuardReason::kDeviceFault ||
              loop.guarded.reason == GuardReason::kLateInput);
  // For good: nobody is there.
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(loop.tick().written);
  EXPECT_GE(loop.faults, 20);
  EXPECT_EQ(loop.guarded.state, GuardState::kSafe);
  expect_fresh_forces();
}

TEST_F(UdpKill, a_device_that_stands_still_is_a_late_input_and_ends_the_force) {
  const Child server([&] { serve(); });
  await([&] { return shared_.port != 0; });
  UdpDevice device(shared_.port, kKillPatience);
  GuardedLoop loop{device, shared_.loop};
  loop.push();
  server.stop();
  const Nanoseconds start = monotonic_time();
  while (loop.tick().out.state != GuardState::kSafe)
    ASSERT_LT(monotonic_time() - start, kKillPatience);
  loop.report_end("SIGSTOP of the device");
  EXPECT_EQ(loop.guarded.reason, GuardReason::kLateInput);
  EXPECT_EQ(loop.faults, 0);
  // Long enough for its queue to be full of old forces.
  for (int i = 0; i < 500; ++i) loop.tick();
  const std::uint64_t stood = loop.ticks.back().state.sequence;
  server.signal(SIGCONT);
  while (loop.tick().state.sequence < stood + 10)
    ASSERT_LT(monotonic_time() - start, kKillPatience);
  EXPECT_EQ(loop.guarded.state, GuardState::kSafe);
  EXPECT_EQ(loop.guarded.reason, GuardReason::kLateInput);
  // A person may go on.
  loop.push();
  loop.expect_guarded();
  expect_fresh_forces();
}

// Without a guard and at full force: what the queue held is not given to the device.
TEST_F(UdpKill, a_device_that_stood_still_takes_no_old_force) {
  const Child device([&] { serve(); });
  const Child loop([&] { push(); });
  await_force(0);
  device.stop();
  const Nanoseconds stood = shared_.device.last().now;
  await([&] { return shared_.loop.last().now > stood + 500ms; });
  const std::uint64_t before = shared_.device.size();
  device.signal(SIGCONT);
  await_force(before + 10);
  // It may have stood still in the midst of a tick, which it ends then.
  std::uint64_t first = before;
  while (shared_.device.entries[first].now < stood + 100ms) ++first;
  EXPECT_LE(first, before + 1);
  EXPECT_EQ(shared_.device.entries[first].force, Vec3::Zero());
  expect_fresh_forces();
}

}  // namespace
}  // namespace gliss
