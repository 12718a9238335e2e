// Whose force a served device has, and until when. Ticks at times that the tests choose.
#include "gliss/device/udp_server.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

#include "gliss/thread/realtime.h"
#include "tests/device/udp_fakes.h"
#include "tests/support/allocations.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using test::Peer;
using ::testing::HasSubstr;

constexpr Nanoseconds kWatchdog = 20ms;
constexpr Nanoseconds kLastTick = kWatchdog - 1ms;  // the next would be too late

struct Served {
  void step(Nanoseconds later = 1ms) {
    now += later;
    server.step(now);
  }
  // A loop that has the device and pushes 2 N.
  void push(Peer& loop, std::uint64_t sequence = 1) {
    loop.force({2, 0, 0}, sequence, now);
    step(0ms);
    ASSERT_EQ(device.last, Vec3(2, 0, 0));
  }

  test::FakeDevice device;
  // Its own loop's force, without a guard.
  UdpServer server{device, 0, {.guard = std::nullopt}};
  Nanoseconds now = monotonic_time();
};

TEST(UdpServer, refuses_options_that_are_none) {
  test::FakeDevice device;
  for (const Nanoseconds watchdog : {Nanoseconds(0ns), Nanoseconds(-1ms), Nanoseconds(20ms + 1ns)})
    EXPECT_THROW(UdpServer(device, 0, {.watchdog = watchdog}), std::invalid_argument);
  for (const Nanoseconds period : {Nanoseconds(0ns), Nanoseconds(-1ms), Nanoseconds(20ms)})
    EXPECT_THROW(UdpServer(device, 0, {.period = period}), std::invalid_argument);
}

TEST(UdpServer, names_the_port_that_another_program_has) {
  Served served;
  const auto port = served.server.port();
  const std::string error =
      test::message_of<LoopError>([&] { UdpServer(served.device, served.server.port()); });
  EXPECT_THAT(error, HasSubstr("udp:" + std::to_string(port)));
  EXPECT_THAT(error, HasSubstr("cure: end the program that has it"));
}

TEST(UdpServer, has_no_force_and_sends_nothing_before_a_loop_comes) {
  Served served;
  Peer loop(served.server);
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().sent, 0u);
  loop.force(Vec3::Zero(), 1, served.now);
  served.step();
  served.step();
  const auto state = loop.receive<udp::StateDatagram>();
  ASSERT_TRUE(state);
  EXPECT_EQ(state->sequence, 3u);
  EXPECT_EQ(udp::vector(state->position), test::FakeDevice::position(3));
  EXPECT_EQ(state->measured, served.now.count());
  EXPECT_EQ(served.server.counts().answered, 77u);
}

TEST(UdpServer, gives_the_device_the_newest_force) {
  Served served;
  Peer loop(served.server);
  loop.force({1, 0, 0}, 1, served.now);
  loop.force({3, 0, 0}, 3, served.now);
  loop.force({2, 0, 0}, 2, served.now);
  loop.force({2, 0, 0}, 3, served.now);
  served.step();
  EXPECT_EQ(served.device.last, Vec3(3, 0, 0));
  EXPECT_EQ(served.server.counts().received, 2u);
  EXPECT_EQ(served.server.counts().ignored, 2u);
}

TEST(UdpServer, gives_the_device_no_more_than_it_can) {
  Served served;
  Peer loop(served.server);
  std::uint64_t sequence = 0;
  for (const Vec3& wanted : {Vec3(3.1, 0, 0), Vec3(-9, 9, 9)}) {
    loop.force(wanted, ++sequence, served.now);
    served.step();
    EXPECT_LE(served.device.last.norm(), 3);
    EXPECT_LE((served.device.last - 3 * wanted.normalized()).norm(), 1e-12);
  }
  loop.force({1e300, 1e300, -1e300}, ++sequence, served.now);  // nobody means that
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
}

TEST(UdpServer, takes_the_force_away_before_it_is_20_ms_old) {
  Served served;
  Peer loop(served.server);
  served.push(loop);
  served.step(kLastTick);
  EXPECT_EQ(served.device.last, Vec3(2, 0, 0));
  EXPECT_EQ(served.server.counts().watchdog_trips, 0u);
  served.step(1ns);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.step();
  EXPECT_EQ(served.server.counts().watchdog_trips, 1u);
  // It comes back.
  served.push(loop, 2);
  EXPECT_EQ(served.server.counts().peers, 2u);
}

// Forces that were sent already come again, stamped as if they were new.
TEST(UdpServer, takes_the_force_away_under_datagrams_that_are_replayed) {
  Served served;
  Peer loop(served.server);
  for (std::uint64_t sequence = 1; sequence <= 5; ++sequence) {
    if (sequence > 1) served.step();
    served.push(loop, sequence);
  }
  for (std::uint64_t i = 0; i < 40; ++i) {
    for (std::uint64_t sequence = 1; sequence <= 5; ++sequence)
      loop.force({2, 0, 0}, sequence, served.now);
    served.step();
    EXPECT_EQ(served.device.last == Vec3::Zero(), i * 1ms >= kLastTick) << i;
  }
  EXPECT_EQ(served.server.counts().ignored, 200u);
  EXPECT_EQ(served.server.counts().watchdog_trips, 1u);
}

// The queue holds what was sent first, as after a process stood still.
TEST(UdpServer, takes_no_force_that_waited_for_long) {
  Served served;
  Peer loop(served.server);
  served.push(loop);
  for (std::uint64_t i = 2; i < 50; ++i) loop.force({2, 0, 0}, i, served.now + i * 1ms);
  served.step(100ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().ignored, 48u);
  served.push(loop, 50);
}

TEST(UdpServer, takes_no_force_from_a_clock_that_is_ahead) {
  Served served;
  Peer loop(served.server);
  loop.force({2, 0, 0}, 1, served.now + 1h);
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().rejected, 1u);
  // A tick that is late itself finds what was sent meanwhile; it ages from then on.
  loop.force({2, 0, 0}, 2, served.now + 10ms);
  served.step();
  EXPECT_EQ(served.device.last, Vec3(2, 0, 0));
  served.step(kLastTick + 1ns);
  EXPECT_EQ(served.device.last, Vec3::Zero());
}

TEST(UdpServer, ends_the_force_with_a_bye) {
  Served served;
  Peer loop(served.server), next(served.server);
  served.push(loop);
  for (std::uint64_t i = 2; i < 5; ++i) loop.force({2, 0, 0}, i, served.now, udp::kBye);
  served.step(0ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.push(next);
  EXPECT_EQ(served.server.counts().watchdog_trips, 0u);
}

// It waited in the queue, as after a process stood still: the place is free at once all the same.
TEST(UdpServer, takes_a_bye_however_old_it_is) {
  Served served;
  Peer loop(served.server), next(served.server);
  served.push(loop);
  loop.force({2, 0, 0}, 2, served.now, udp::kBye);
  served.step(30ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.push(next);
}

TEST(UdpServer, ends_the_force_in_the_tick_that_finds_the_loop_dead) {
  Served served;
  {
    Peer loop(served.server);
    served.push(loop);
  }
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().lost, 1u);
}

TEST(UdpServer, leaves_strangers_out_while_its_loop_lives) {
  Served served;
  Peer loop(served.server), early(served.server), late(served.server);
  loop.force({2, 0, 0}, 1, served.now);
  early.force({-3, 0, 0}, 9, served.now);  // in the queue before the loop is known
  early.force({-3, 0, 0}, 10, served.now, udp::kBye);
  served.step();
  EXPECT_EQ(served.device.last, Vec3(2, 0, 0));
  EXPECT_EQ(served.server.counts().ignored, 2u);
  for (int i = 0; i < 100; ++i) {
    late.force({-3, 0, 0}, 100, served.now);
    late.garbage();
  }
  served.step();
  EXPECT_EQ(served.device.last, Vec3(2, 0, 0));
  EXPECT_EQ(served.server.counts().ignored + served.server.counts().rejected, 2u);
  late.receive<udp::StateDatagram>();  // takes what earlier ones met
  late.force({-3, 0, 0}, 101, served.now);
  late.receive<udp::StateDatagram>();
  EXPECT_TRUE(late.refused);
}

TEST(UdpServer, keeps_the_place_of_a_loop_that_stands_still_for_a_while) {
  Served served;
  Peer loop(served.server), next(served.server);
  served.push(loop);
  served.step(30ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  next.force({-3, 0, 0}, 1, served.now);
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.push(loop, 2);
  served.step(udp::kPlaceKept);
  next.receive<udp::StateDatagram>();  // takes what the earlier one met
  next.force({-3, 0, 0}, 2, served.now);
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.step();  // silent for longer than that
  next.receive<udp::StateDatagram>();
  served.push(next, 3);
}

TEST(UdpServer, refuses_who_has_not_its_pass_and_says_so) {
  Served served;
  Peer thief(served.server);
  for (const bool other : {false, true}) {
    thief.pass = std::nullopt;
    if (other) (thief.pass = served.server.pass())->back() ^= std::byte{1};
    thief.force({3, 0, 0}, 1, served.now);
    served.step();
    EXPECT_EQ(served.device.last, Vec3::Zero());
    EXPECT_TRUE(thief.receive<udp::RefusalDatagram>());
  }
  EXPECT_EQ(served.server.counts().refused, 2u);
  EXPECT_EQ(served.server.counts().peers, 0u);
}

// The file of a port's pass, in one of the two places that docs/safety.md names.
std::string pass_file(std::uint16_t port) {
  const auto user = std::to_string(geteuid()), name = "udp-" + std::to_string(port);
  const std::string session = "/run/user/" + user + "/gliss-" + name;
  return access(session.c_str(), F_OK) == 0 ? session : "/tmp/gliss-" + user + "/" + name;
}

TEST(UdpServer, has_a_pass_that_its_owner_alone_can_read) {
  std::uint16_t port = 0;
  {
    const mode_t mask = umask(0);  // files are for everybody, unless they say otherwise
    Served served;
    umask(mask);
    port = served.server.port();
    const udp::Pass pass = served.server.pass();
    const auto found = udp::find_pass(port);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->pass, pass);
    EXPECT_TRUE(found->served);
    EXPECT_NE(udp::OwnPass(1).value(), pass);
    const std::string path = pass_file(port);
    for (const std::string& name : {path, path.substr(0, path.rfind('/'))}) {
      struct stat status {};
      ASSERT_EQ(lstat(name.c_str(), &status), 0) << name;
      EXPECT_EQ(status.st_uid, geteuid()) << name;
      EXPECT_EQ(status.st_mode & 077, 0u) << name;
    }
    // Nor is one believed that others could have read, or that lies elsewhere.
    const auto refusal = [&] { return test::message_of<LoopError>([&] { udp::find_pass(port); }); };
    ASSERT_EQ(chmod(path.c_str(), 0644), 0);
    EXPECT_THAT(refusal(), HasSubstr("cannot be read as this user's own"));
    const test::ScratchFolder folder;
    const std::string elsewhere = folder.write("pass", std::string(pass.size(), 'x'));
    ASSERT_EQ(chmod(elsewhere.c_str(), 0600), 0);
    ASSERT_EQ(unlink(path.c_str()), 0);
    ASSERT_EQ(symlink(elsewhere.c_str(), path.c_str()), 0);
    EXPECT_THAT(refusal(), HasSubstr("cannot be read as this user's own"));
  }
  EXPECT_FALSE(udp::find_pass(port));
}

// Whoever listens everywhere is found at this machine's other addresses too.
TEST(UdpServer, listens_on_127_0_0_1_alone) {
  Served served;
  for (const std::uint32_t host : {INADDR_LOOPBACK + 1, INADDR_LOOPBACK}) {
    const int other = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(host);
    address.sin_port = htons(served.server.port());
    ASSERT_EQ(connect(other, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const auto rejected = [&] { return served.server.counts().rejected; };
    const std::uint64_t before = rejected();
    const bool ours = host == INADDR_LOOPBACK;
    EXPECT_EQ(send(other, "?", 1, 0), 1);
    served.step();
    EXPECT_EQ(rejected() - before, ours ? 1u : 0u);
    EXPECT_EQ(send(other, "?", 1, 0), ours ? 1 : -1);
    EXPECT_TRUE(ours || errno == ECONNREFUSED);
    close(other);
  }
}

// Without a word from the loop's own guards: the device's are enough.
class GuardedServer : public ::testing::Test {
 protected:
  void push(const Vec3& force) {
    loop_.force(force, ++sequence_, now_ += 1ms);
    server_.step(now_);
    largest_step_ = std::max(largest_step_, (device_.last - last_).norm());
    last_ = device_.last;
  }
  // From a hand in the open.
  void engage() {
    for (int i = 0; i < 600; ++i) push(Vec3::Zero());
  }

  test::FakeDevice device_;
  UdpServer server_{device_, 0};
  Peer loop_{server_};
  Nanoseconds now_ = monotonic_time();
  std::uint64_t sequence_ = 0;
  Vec3 last_ = Vec3::Zero();
  double largest_step_ = 0;
};

TEST_F(GuardedServer, lets_no_force_change_faster_than_it_may) {
  engage();
  for (int i = 0; i < 2000; ++i) push({i % 2 ? 3.0 : -3.0, 0, 0});
  EXPECT_LE(largest_step_, 1 + 1e-9);
  EXPECT_GT(largest_step_, 0.5);
}

TEST_F(GuardedServer, lets_no_more_than_a_touch_out_before_the_hand_was_in_the_open) {
  for (int i = 0; i < 2000; ++i) push({3, 0, 0});
  EXPECT_LE(last_.norm(), 0.2 + 1e-9);
  engage();
  for (int i = 0; i < 10; ++i) push({2, 0, 0});
  EXPECT_EQ(last_, Vec3(2, 0, 0));
}

TEST_F(GuardedServer, fades_a_silent_loop_out_and_starts_it_again_in_the_open) {
  engage();
  for (int i = 0; i < 10; ++i) push({2, 0, 0});
  ASSERT_EQ(last_, Vec3(2, 0, 0));
  for (int i = 0; i < 10; ++i) server_.step(now_ += 1ms);
  EXPECT_EQ(device_.last, Vec3::Zero());
  for (int i = 0; i < 100; ++i) push({2, 0, 0});
  EXPECT_EQ(last_, Vec3::Zero());
  engage();
  for (int i = 0; i < 10; ++i) push({2, 0, 0});
  EXPECT_EQ(last_, Vec3(2, 0, 0));
}

TEST_F(GuardedServer, engages_no_loop_again_by_itself_after_a_clock_that_stood_still) {
  engage();
  for (int i = 0; i < 10; ++i) server_.step(now_);
  engage();
  for (int i = 0; i < 10; ++i) push({2, 0, 0});
  EXPECT_EQ(last_, Vec3::Zero());
}

// A loop is in the open for some ticks and then pushes for some. Returns the time of the last.
Nanoseconds push_from_the_open(UdpServer& server, Peer& loop, std::uint64_t open, const Vec3& force,
                               std::uint64_t pushed) {
  Nanoseconds now = monotonic_time();
  for (std::uint64_t i = 1; i <= open + pushed; ++i) {
    loop.force(i <= open ? Vec3::Zero() : force, i, now += 1ms);
    server.step(now);
  }
  return now;
}

// The watchdog ends a force that the guard would still let through.
TEST(UdpServer, takes_the_force_away_in_time_with_a_guard_that_is_slower) {
  test::FakeDevice device;
  UdpServer server(device, 0, {.watchdog = 5ms});
  Peer loop(server);
  const Nanoseconds now = push_from_the_open(server, loop, 600, {2, 0, 0}, 10);
  ASSERT_EQ(device.last, Vec3(2, 0, 0));
  server.step(now + 4ms);
  EXPECT_NE(device.last, Vec3::Zero());
  server.step(now + 4ms + 1ns);
  EXPECT_EQ(device.last, Vec3::Zero());
}

// The ramp after it engages ends with what the device can, not above.
TEST(UdpServer, lets_a_weak_device_begin_as_gently_as_a_strong_one) {
  struct Weak : test::FakeDevice {
    Weak() { info_.max_force = 1; }
  } device;
  UdpServer server(device, 0);
  Peer loop(server);
  const auto half = static_cast<std::uint64_t>(GuardLimits{}.engage_ramp / 2ms);
  push_from_the_open(server, loop, half, {1, 0, 0}, 5);
  EXPECT_GT(device.last.x(), 0.4);
  EXPECT_LT(device.last.x(), 0.6);
}

// By max_rate, not at once; then the place is free.
TEST_F(GuardedServer, lets_the_force_of_a_loop_that_ends_fade) {
  for (const bool says_bye : {true, false}) {
    SCOPED_TRACE(says_bye);
    std::optional<Peer> loop(server_);
    std::uint64_t sequence = 0;
    const auto push = [&](const Vec3& force, std::uint16_t flags = 0) {
      loop->force(force, ++sequence, now_ += 1ms, flags);
      server_.step(now_);
    };
    for (int i = 0; i < 600; ++i) push(Vec3::Zero());
    for (int i = 0; i < 10; ++i) push({3, 0, 0});
    ASSERT_EQ(device_.last, Vec3(3, 0, 0));
    double last = 3;
    if (says_bye) {
      push({3, 0, 0}, udp::kBye);
    } else {
      loop.reset();
      server_.step(now_ += 1ms);
    }
    Peer next(server_);
    for (std::uint64_t i = 1; device_.last.norm() > 0 && i < 30; ++i) {
      EXPECT_GT(device_.last.norm(), last - 1 - 1e-9);
      EXPECT_LE(device_.last.norm(), last);
      last = device_.last.norm();
      next.force({3, 0, 0}, i, now_ += 1ms);
      server_.step(now_);
    }
    EXPECT_LE(last, 1 + 1e-9);
    EXPECT_EQ(device_.last, Vec3::Zero());
    next.force({3, 0, 0}, 99, now_, udp::kBye);
    for (int i = 0; i < 30; ++i) server_.step(now_ += 1ms);
  }
}

// A person ends the server while it pushes.
TEST(UdpServer, lets_the_force_fade_when_it_is_stopped) {
  struct Recorder : test::FakeDevice {
    bool write(const Vec3& force, Nanoseconds now) noexcept override {
      sizes.push_back(force.norm());
      return FakeDevice::write(force, now);
    }
    std::vector<double> sizes;
  } device;
  UdpServer server(device, 0);
  Peer loop(server);
  std::uint64_t sequence = 0;
  server.run([&] {
    const bool is_over = device.last == Vec3(2, 0, 0);
    // In the open for as long as engaging takes; again where a busy machine was late.
    const Vec3 force = ++sequence % 1000 < 600 ? Vec3::Zero() : Vec3(2, 0, 0);
    loop.force(force, sequence, monotonic_time());
    if (is_over) device.sizes = {2};
    return is_over;
  });
  EXPECT_GT(device.sizes.size(), 3u);
  for (std::size_t i = 1; i < device.sizes.size(); ++i)
    EXPECT_GT(device.sizes[i], device.sizes[i - 1] - 1.9);  // a tick may be late
  EXPECT_EQ(device.sizes.back(), 0);
}

TEST(UdpServer, takes_garbage_and_floods_in_small_bites) {
  Served served;
  Peer pest(served.server), loop(served.server);
  for (int i = 0; i < 1000; ++i) pest.garbage();  // more than the queue can hold
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().rejected, std::uint64_t{UdpServer::kDrain});
  for (int i = 0; i < 1000; ++i) served.step();
  EXPECT_EQ(served.server.counts().received, 0u);
  // Its own loop's flood too: the newest comes a tick later.
  served.push(loop);
  for (std::uint64_t i = 2; i < 100; ++i) {
    loop.force({static_cast<double>(i) / 100, 0, 0}, i, served.now);
  }
  served.step();
  EXPECT_EQ(served.device.last.x(), (UdpServer::kDrain + 1) / 100.0);
  served.step();
  EXPECT_EQ(served.device.last.x(), 0.99);
}

TEST(UdpServer, says_that_the_device_failed) {
  Served served;
  Peer loop(served.server);
  served.push(loop);
  const auto flags = [&] {
    served.step();
    const auto state = loop.receive<udp::StateDatagram>();
    return state ? state->flags & (udp::kFault | udp::kEnded) : -1;
  };
  EXPECT_EQ(flags(), 0);
  served.device.accepts = false;
  EXPECT_EQ(flags(), 0);
  EXPECT_EQ(flags(), udp::kFault);
  served.device.accepts = true;
  served.device.state.ended = true;
  flags();
  EXPECT_EQ(flags(), udp::kEnded);
}

TEST(UdpServer, leaves_no_force_however_it_ends) {
  for (const char* way : {"stop", "exception", "destruction"}) {
    SCOPED_TRACE(way);
    test::FakeDevice device;
    Peer loop;
    {
      UdpServer server(device, 0, {.guard = std::nullopt});
      loop.socket.connect(server.port());
      loop.pass = server.pass();
      loop.force({2, 0, 0}, 1, monotonic_time());
      if (way == std::string("destruction")) {
        server.step(monotonic_time());
      } else {
        std::uint64_t sequence = 1;
        const auto stop = [&] {
          if (device.last != Vec3(2, 0, 0)) {
            loop.force({2, 0, 0}, ++sequence, monotonic_time());
            return false;
          }
          if (way == std::string("exception")) throw std::runtime_error("enough");
          return true;
        };
        if (way == std::string("exception")) {
          EXPECT_THROW(server.run(stop), std::runtime_error);
        } else {
          server.run(stop);
        }
        EXPECT_EQ(device.last, Vec3::Zero());
      }
      device.last = Vec3(2, 0, 0);
    }
    EXPECT_EQ(device.last, Vec3::Zero());
  }
}

// A hand that follows a path would be inside before anybody feels it.
TEST(UdpServer, leaves_a_device_that_waits_alone_until_the_first_loop_comes) {
  test::FakeDevice device;
  UdpServer server(device, 0, {.guard = std::nullopt, .waits = true});
  Nanoseconds now = monotonic_time();
  const auto step = [&] { server.step(now += 1ms); };
  for (int i = 0; i < 100; ++i) step();
  EXPECT_EQ(device.state.sequence, 0u);
  EXPECT_EQ(device.last, Vec3(9, 9, 9));  // not written
  Peer loop(server);
  loop.force(Vec3::Zero(), 1, now);
  step();
  step();
  const auto state = loop.receive<udp::StateDatagram>();
  ASSERT_TRUE(state);
  EXPECT_EQ(state->sequence, 1u);
  loop.force(Vec3::Zero(), 2, now, udp::kBye);
  for (int i = 0; i < 10; ++i) step();
  EXPECT_EQ(device.state.sequence, 11u);  // goes on without a loop
}

TEST(UdpServer, tells_the_loop_that_nothing_comes_after) {
  Served served;
  Peer loop(served.server);
  served.push(loop);
  served.step();
  served.server.end();
  int ended = 0;
  while (const auto state = loop.receive<udp::StateDatagram>()) {
    ended += (state->flags & udp::kEnded) != 0 ? 1 : 0;
  }
  EXPECT_GE(ended, 1);
}

TEST(UdpServer, ticks_allocate_nothing) {
  Served served;
  Peer loop(served.server);
  const std::uint64_t before = test::allocations();
  for (std::uint64_t i = 1; i < 2000; ++i) {
    loop.force({1, 0, 0}, i, served.now, i % 100 == 0 ? udp::kBye : std::uint16_t{0});
    served.step();
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(served.server.counts().peers, 10u);
}

}  // namespace
}  // namespace gliss
