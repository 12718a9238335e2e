// A device behind a UDP port, as the loop sees it: against a server in a thread, and against an end
// whose every datagram the tests choose.
#include "gliss/device/udp_device.h"

#include <gmock/gmock.h>

#include <future>
#include <memory>
#include <thread>

#include "gliss/device/udp_server.h"
#include "gliss/thread/realtime.h"
#include "tests/device/udp_fakes.h"
#include "tests/support/allocations.h"
#include "tests/support/numbers.h"
#include "tests/support/scratch_folder.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;
using test::FakeDevice, test::kNaN, test::Peer;
using ::testing::AllOf, ::testing::HasSubstr;

constexpr Nanoseconds kLong = 30s;  // a machine may be that slow

// True once `condition` holds; tries until kLong is over.
template <class Condition>
bool eventually(Condition condition) {
  const Nanoseconds start = monotonic_time();
  while (!condition()) {
    if (monotonic_time() - start > kLong) return false;
    std::this_thread::sleep_for(200us);
  }
  return true;
}

// A server in a thread of its own.
struct ServedThread {
  ~ServedThread() { end(); }
  void end() {
    stop = true;
    if (thread.joinable()) thread.join();
  }
  FakeDevice device;
  UdpServer server{device, 0, {.guard = std::nullopt}};
  std::atomic<bool> stop{false};
  std::thread thread{[this] { server.run([this] { return stop.load(); }); }};
};

// A device, and the other end in the test's hands.
struct Connected {
  Connected() {
    auto opening = std::async(std::launch::async, [this] {
      return std::make_unique<UdpDevice>(end->socket.port(), kLong);
    });
    EXPECT_TRUE(eventually([&] { return end->receive<udp::ForceDatagram>().has_value(); }));
    port = end->from;
    end->socket.connect(port);
    end->state(1);
    device = opening.get();
    clear();
  }
  void clear() {
    while (end->receive<udp::ForceDatagram>()) {
    }
  }
  DeviceState read() { return device->read(monotonic_time()); }
  bool write(const Vec3& force) { return device->write(force, monotonic_time()); }

  std::unique_ptr<Peer> end = std::make_unique<Peer>();
  std::uint16_t port = 0;  // the device's
  std::unique_ptr<UdpDevice> device;
};

TEST(UdpDevice, brings_positions_and_takes_forces) {
  ServedThread served;
  UdpDevice device(served.server.port());
  EXPECT_EQ(device.info().name, "udp:" + std::to_string(served.server.port()));
  EXPECT_EQ(device.info().max_force, 3);
  EXPECT_EQ(device.info().max_stiffness, 700);
  EXPECT_EQ(device.info().workspace.max(), Vec3(0.4, 0.5, 0.6));
  EXPECT_TRUE(device.info().has_velocity);

  DeviceState before;
  Nanoseconds youngest = 1h;
  const bool done = eventually([&] {
    const Nanoseconds now = monotonic_time();
    const DeviceState state = device.read(now);
    EXPECT_EQ(state.position, FakeDevice::position(state.sequence));
    EXPECT_EQ(state.velocity, Vec3(1, 2, 3));
    EXPECT_GE(state.sequence, before.sequence);
    EXPECT_GE(state.measured, before.measured);
    EXPECT_LE(state.measured, now);
    EXPECT_FALSE(state.fault || state.ended);
    youngest = std::min(youngest, now - state.measured);
    before = state;
    EXPECT_TRUE(device.write(Vec3(0, 1.5, 0), now));
    return state.sequence > 100 && served.device.size == 1.5;
  });
  EXPECT_TRUE(done);
  EXPECT_LT(youngest, 10ms);
  EXPECT_EQ(device.rejected() + device.outdated(), 0u);
}

// A device that turns: through server, wire and device, with the guard between.
TEST(UdpDevice, brings_orientations_and_takes_torques) {
  FakeDevice fake;
  fake.turn();
  UdpServer server(fake, 0, {.guard = std::nullopt});
  std::atomic<bool> stop = false;
  std::thread thread([&] { server.run([&] { return stop.load(); }); });
  {
    UdpDevice device(server.port());
    EXPECT_TRUE(device.info().has_orientation);
    EXPECT_EQ(device.info().max_torque, 0.2);
    EXPECT_EQ(device.info().max_force, 3);
    const bool done = eventually([&] {
      const DeviceState state = device.read(monotonic_time());
      EXPECT_EQ(state.orientation.coeffs(), Rotation(0, 0, 1, 0).coeffs());
      // More than the motors give, and a torque that is none.
      const bool is_none = state.sequence % 7 == 0;
      EXPECT_TRUE(
          device.write_wrench({Vec3(0, 1.5, 0), Vec3(0, 0, is_none ? kNaN : 5)}, monotonic_time()));
      return state.sequence > 50 && fake.size == 1.5 && device.rejected() == 0;
    });
    EXPECT_TRUE(done);
  }
  stop = true;
  thread.join();
  EXPECT_TRUE(fake.torque.isZero(0));  // the last that was written
  EXPECT_EQ(server.counts().rejected, 0u);
}

// A server that steps by hand: what comes from the wire is no more than the motors give, and goes
// with the watchdog.
TEST(UdpServer, hands_a_torque_on_within_its_limit_and_takes_it_away) {
  FakeDevice fake;
  fake.turn();
  UdpServer server(fake, 0, {.guard = std::nullopt});
  Peer loop(server);
  Nanoseconds now = monotonic_time();
  for (std::uint64_t i = 1; i < 5; ++i) {
    udp::WrenchDatagram wrench;
    wrench.force.sequence = i;
    wrench.force.sent = now.count();
    wrench.torque = {0, 0.5, 0};
    loop.socket.send(udp::encode(udp::PassedWrenchDatagram{wrench, *loop.pass}));
    server.step(now += 1ms);
  }
  EXPECT_NEAR(fake.torque.y(), 0.2, 1e-9);
  server.step(now += 25ms);
  EXPECT_TRUE(fake.torque.isZero(0));
}

TEST(UdpServer, refuses_a_torque_without_a_pass) {
  FakeDevice fake;
  fake.turn();
  UdpServer server(fake, 0);
  Peer stranger(server.port());
  stranger.socket.send(udp::encode(udp::WrenchDatagram{}));
  udp::WrenchDatagram valid;
  valid.force.sequence = 9;
  stranger.socket.send(udp::encode(valid));
  server.step(monotonic_time());
  EXPECT_EQ(server.counts().refused, 1u);
}

TEST(UdpDevice, takes_its_force_along_when_it_is_destroyed) {
  ServedThread served;
  {
    UdpDevice device(served.server.port());
    EXPECT_TRUE(eventually([&] {
      device.write(Vec3(2, 0, 0), monotonic_time());
      return served.device.size == 2;
    }));
  }
  EXPECT_TRUE(eventually([&] { return served.device.size == 0; }));
}

TEST(UdpDevice, says_bye_more_than_once) {
  Connected c;
  c.device.reset();
  int byes = 0;
  while (const auto force = c.end->receive<udp::ForceDatagram>()) {
    EXPECT_EQ(udp::vector(force->force), Vec3::Zero());
    byes += (force->flags & udp::kBye) != 0 ? 1 : 0;
  }
  EXPECT_GE(byes, 2);
}

TEST(UdpDevice, names_the_port_and_the_cure_where_nobody_answers) {
  const auto port = udp::Socket().port();
  const std::string error = test::message_of<LoopError>([&] { UdpDevice(port, 50ms); });
  EXPECT_THAT(error, HasSubstr("udp:" + std::to_string(port) + ": no haptic device answered"));
  EXPECT_THAT(error, HasSubstr("cure: start the device's program or gliss serve"));
  EXPECT_EQ(error.find('\n'), std::string::npos);
  EXPECT_THROW(UdpDevice(0), std::invalid_argument);
}

TEST(UdpDevice, is_not_given_to_a_second_loop) {
  ServedThread served;
  UdpDevice first(served.server.port());
  std::atomic<bool> stop{false};
  std::thread loop([&] {
    while (!stop) {
      first.write(Vec3(1, 0, 0), monotonic_time());
      std::this_thread::sleep_for(200us);
    }
  });
  // Where the first was kept from the processor for long, the second may have the device.
  const std::string error =
      test::message_of<LoopError>([&] { UdpDevice(served.server.port(), 20ms); });
  stop = true;
  loop.join();
  served.end();
  if (served.server.counts().watchdog_trips == 0) {
    EXPECT_THAT(error, HasSubstr("refused this loop, for another has it"));
  }
}

TEST(UdpDevice, goes_by_the_order_of_sequences) {
  Connected c;
  for (const std::uint64_t sequence : {5, 9, 7, 8, 1}) c.end->state(sequence);
  EXPECT_EQ(c.read().sequence, 9u);
  EXPECT_EQ(c.read().position, FakeDevice::position(9));
  EXPECT_EQ(c.device->outdated(), 3u);
  // The same measurement, and news.
  c.end->state(9, 1, udp::kFault);
  EXPECT_TRUE(c.read().fault);
  c.end->state(10, 1, udp::kEnded);
  EXPECT_TRUE(c.read().ended);
}

TEST(UdpDevice, is_never_measured_after_now) {
  Connected c;
  c.end->state(2);
  EXPECT_EQ(c.device->read(5ns).measured, 5ns);
}

TEST(UdpDevice, takes_no_state_from_a_clock_that_is_ahead) {
  Connected c;
  c.end->ahead = 1s;
  for (std::uint64_t i = 2; i < 50; ++i) c.end->state(i);
  EXPECT_EQ(c.read().sequence, 1u);
  EXPECT_EQ(c.device->rejected(), 48u);
}

TEST(UdpDevice, is_told_that_it_was_refused) {
  ServedThread served;
  const auto port = served.server.port();
  const udp::OwnPass another(port);  // takes the file's place, as if the port were another user's
  EXPECT_THAT(test::message_of<LoopError>([&] { UdpDevice(port, kLong); }),
              AllOf(HasSubstr("refused this loop, for it lacks the pass; another one was found in"),
                    HasSubstr(udp::pass_paths(port))));
}

// A server that is bound and has neither its pass nor ticks yet: it refuses all that was asked
// meanwhile, more than a tick takes, when it has them.
TEST(UdpDevice, bears_refusals_of_what_it_asked_before_there_was_a_pass) {
  FakeDevice fake;
  UdpServer server(fake, 0, {.guard = std::nullopt});
  { const udp::OwnPass removed(server.port()); }
  auto opening = std::async(std::launch::async, [&] {
    return UdpDevice(server.port(), kLong).read(monotonic_time()).sequence;
  });
  std::this_thread::sleep_for(500ms);
  while (opening.wait_for(10ms) != std::future_status::ready) server.step(monotonic_time());
  EXPECT_GT(opening.get(), 0u);
  EXPECT_GT(server.counts().refused, std::uint64_t{UdpServer::kDrain});
}

TEST(UdpDevice, finds_a_pass_that_went_with_its_folder) {
  ServedThread served;
  const auto port = served.server.port();
  { const udp::OwnPass removed(port); }  // and its file, as at the end of a session
  ASSERT_FALSE(udp::find_pass(port));
  EXPECT_GT(UdpDevice(port, kLong).read(monotonic_time()).sequence, 0u);
  EXPECT_TRUE(udp::find_pass(port));
}

TEST(UdpDevice, answers_the_state_that_it_read_and_sends_nothing_but_numbers) {
  Connected c;
  c.end->state(6);
  c.read();
  std::uint64_t before = 0;
  for (const Vec3& wanted : {Vec3(1, -2, 3), Vec3(kNaN, 1, 1), Vec3(1, HUGE_VAL, 1)}) {
    EXPECT_TRUE(c.device->write(wanted, 123ns));
    const auto force = c.end->receive<udp::ForceDatagram>();
    ASSERT_TRUE(force);
    EXPECT_EQ(udp::vector(force->force), wanted.allFinite() ? wanted : Vec3(Vec3::Zero()));
    EXPECT_EQ(force->answers, 6u);
    EXPECT_EQ(force->sent, 123);
    EXPECT_GT(force->sequence, before);
    before = force->sequence;
  }
}

TEST(UdpDevice, refuses_garbage_and_hears_no_strangers) {
  Connected c;
  Peer stranger(c.port);
  c.end->garbage();
  stranger.state(99);
  EXPECT_EQ(c.read().sequence, 1u);
  while (c.device->rejected() < udp::kLargest + 2) c.read();  // one of each size
  c.end->state(2);
  EXPECT_EQ(c.read().sequence, 2u);
  EXPECT_EQ(c.device->rejected(), udp::kLargest + 2);
}

TEST(UdpDevice, reads_floods_in_small_bites) {
  Connected c;
  for (std::uint64_t i = 1; i <= 150; ++i) c.end->state(i);
  EXPECT_EQ(c.read().sequence, std::uint64_t{UdpDevice::kDrain});
  EXPECT_EQ(c.read().sequence, std::uint64_t{2 * UdpDevice::kDrain});
  EXPECT_EQ(c.read().sequence, 150u);
}

TEST(UdpDevice, cannot_write_once_the_other_end_is_gone_until_it_is_back) {
  Connected c;
  c.end->state(500);
  EXPECT_EQ(c.read().sequence, 500u);
  EXPECT_TRUE(c.write(Vec3::Zero()));

  const std::uint16_t port = c.end->socket.port();
  c.end.reset();
  EXPECT_TRUE(eventually([&] {
    const DeviceState state = c.read();
    EXPECT_EQ(state.sequence, 500u);
    EXPECT_FALSE(state.fault);
    return !c.write(Vec3::Zero());
  }));
  for (int i = 0; i < 5; ++i) {
    c.read();
    EXPECT_FALSE(c.write(Vec3::Zero()));
  }

  // Started again, it counts from 1; the loop's sequences still grow.
  c.end = std::make_unique<Peer>(c.port, port);
  c.end->state(3, 2);
  c.end->state(900, 1);  // what the first had still in the air
  EXPECT_EQ(c.read().sequence, 503u);
  EXPECT_TRUE(c.write(Vec3::Zero()));
  EXPECT_EQ(c.device->outdated(), 1u);
}

TEST(UdpDevice, reads_and_writes_allocate_nothing) {
  Connected c;
  const std::uint64_t before = test::allocations();
  for (std::uint64_t i = 2; i < 2000; ++i) {
    c.end->state(i);
    EXPECT_EQ(c.read().sequence, i);
    EXPECT_TRUE(c.write(Vec3(1, 2, 3)));
    if (i % 50 == 0) c.clear();
  }
  c.end->garbage();
  c.read();
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace gliss
