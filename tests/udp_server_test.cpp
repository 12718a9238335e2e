// Whose force a served device has, and until when. Ticks at times that the tests choose.
#include "runtime/udp_server.h"

#include <gmock/gmock.h>

#include <stdexcept>

#include "runtime/realtime.h"
#include "tests/allocations.h"
#include "tests/scratch_folder.h"
#include "tests/udp_fakes.h"

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
  UdpServer server{device, 0};
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
  Peer loop(served.server.port());
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
  Peer loop(served.server.port());
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
  Peer loop(served.server.port());
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
  Peer loop(served.server.port());
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

// As after a process stood still: the queue holds what was sent first.
TEST(UdpServer, takes_no_force_that_waited_for_long) {
  Served served;
  Peer loop(served.server.port());
  served.push(loop);
  for (std::uint64_t i = 2; i < 50; ++i) loop.force({2, 0, 0}, i, served.now + i * 1ms);
  served.step(100ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().ignored, 48u);
  served.push(loop, 50);
}

TEST(UdpServer, is_not_fooled_by_a_clock_that_is_ahead) {
  Served served;
  Peer loop(served.server.port());
  loop.force({2, 0, 0}, 1, served.now + 1h);
  served.step();
  EXPECT_EQ(served.device.last, Vec3(2, 0, 0));
  served.step(kLastTick + 1ns);
  EXPECT_EQ(served.device.last, Vec3::Zero());
}

TEST(UdpServer, ends_the_force_with_a_bye) {
  Served served;
  Peer loop(served.server.port()), next(served.server.port());
  served.push(loop);
  for (std::uint64_t i = 2; i < 5; ++i) loop.force({2, 0, 0}, i, served.now, udp::kBye);
  served.step(0ms);
  EXPECT_EQ(served.device.last, Vec3::Zero());
  served.push(next);
  EXPECT_EQ(served.server.counts().watchdog_trips, 0u);
}

TEST(UdpServer, ends_the_force_in_the_tick_that_finds_the_loop_dead) {
  Served served;
  {
    Peer loop(served.server.port());
    served.push(loop);
  }
  served.step();
  EXPECT_EQ(served.device.last, Vec3::Zero());
  EXPECT_EQ(served.server.counts().lost, 1u);
}

TEST(UdpServer, leaves_strangers_out_while_its_loop_lives) {
  Served served;
  Peer loop(served.server.port()), early(served.server.port()), late(served.server.port());
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
  // Once the loop is silent.
  served.step(kWatchdog);
  late.force({1, 0, 0}, 1, served.now);
  served.step();
  EXPECT_EQ(served.device.last, Vec3(1, 0, 0));
}

TEST(UdpServer, takes_garbage_and_floods_in_small_bites) {
  Served served;
  Peer pest(served.server.port()), loop(served.server.port());
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
  Peer loop(served.server.port());
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
      UdpServer server(device, 0);
      loop.socket.connect(server.port());
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

TEST(UdpServer, tells_the_loop_that_nothing_comes_after) {
  Served served;
  Peer loop(served.server.port());
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
  Peer loop(served.server.port());
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
