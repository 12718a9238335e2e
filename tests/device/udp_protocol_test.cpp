// The datagrams: what they carry arrives as it was, and what is none is refused.
#include "gliss/device/udp_protocol.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/device/udp_fakes.h"
#include "tests/support/numbers.h"

namespace gliss::udp {
namespace {

using test::kNaN, test::kInfinity;

DeviceState some_state() {
  DeviceState state;
  state.sequence = 0x0102030405060708;
  state.measured = Nanoseconds(123456789);
  state.position = {0.1, -0.2, 5e-324};
  state.velocity = {1, 2, -3};
  return state;
}

StateDatagram some_state_datagram() {
  return datagram_of(test::FakeDevice().info(), some_state(), 42).state;
}

ForceDatagram some_force_datagram() {
  ForceDatagram d;
  d.flags = kBye;
  d.sequence = 5;
  d.answers = 4;
  d.sent = 3;
  d.force = {0.5, -1, 1e300};
  return d;
}

TEST(UdpProtocol, carries_a_state_and_the_limits) {
  for (const int flags : {0, 1, 2, 3}) {
    DeviceState state = some_state();
    state.fault = (flags & 1) != 0;
    state.ended = (flags & 2) != 0;
    const DeviceInfo info = test::FakeDevice().info();
    const auto got = decode<StateDatagram>(encode(datagram_of(info, state, 42).state));
    ASSERT_TRUE(got);
    EXPECT_EQ(got->session, 42u);
    EXPECT_EQ(got->sequence, state.sequence);
    const DeviceState arrived = state_of({*got});
    EXPECT_EQ(arrived.measured, state.measured);
    EXPECT_EQ(arrived.position, state.position);
    EXPECT_EQ(arrived.velocity, state.velocity);
    EXPECT_EQ(arrived.fault, state.fault);
    EXPECT_EQ(arrived.ended, state.ended);
    const DeviceInfo told = info_of({*got}, false, "udp:1");
    EXPECT_EQ(told.name, "udp:1");
    EXPECT_EQ(told.max_force, info.max_force);
    EXPECT_EQ(told.max_stiffness, info.max_stiffness);
    EXPECT_EQ(told.workspace.min(), info.workspace.min());
    EXPECT_EQ(told.workspace.max(), info.workspace.max());
    EXPECT_TRUE(told.has_velocity);
    EXPECT_TRUE(told.real_time);
  }
}

TEST(UdpProtocol, carries_that_nothing_is_known) {
  const auto got = decode<StateDatagram>(encode(datagram_of({}, some_state(), 42).state));
  ASSERT_TRUE(got);
  const DeviceInfo told = info_of({*got}, false, "");
  EXPECT_EQ(told.max_force, kInfinity);
  EXPECT_EQ(told.max_stiffness, kInfinity);
  EXPECT_TRUE(told.workspace.isEmpty());
  EXPECT_FALSE(told.has_velocity);
  EXPECT_EQ(state_of({*got}).velocity, Vec3::Zero());
}

TEST(UdpProtocol, lays_bytes_where_other_programs_look_for_them) {
  const auto state = encode(some_state_datagram());
  EXPECT_EQ(std::memcmp(state.data(), "GLSS\1\0\1\0\x2a\0\0\0\0\0\0\0\x08\7\6\5\4\3\2\1", 24), 0);
  EXPECT_EQ(state.size(), 144u);
  const auto force = encode(some_force_datagram());
  EXPECT_EQ(std::memcmp(force.data(), "GLSF\1\0\1\0\5\0\0\0\0\0\0\0\4\0\0\0\0\0\0\0\3", 25), 0);
  EXPECT_EQ(std::memcmp(force.data() + 32, "\0\0\0\0\0\0\xe0\x3f", 8), 0);
  EXPECT_EQ(force.size(), 56u);
}

TEST(UdpProtocol, refuses_a_state_that_is_none) {
  using Spoil = void (*)(StateDatagram&);
  const std::vector<std::pair<const char*, Spoil>> cases = {
      {"magic", [](StateDatagram& d) { d.magic = kForceMagic; }},
      {"version", [](StateDatagram& d) { ++d.version; }},
      {"flags", [](StateDatagram& d) { d.flags |= 8; }},
      {"session", [](StateDatagram& d) { d.session = 0; }},
      {"sequence", [](StateDatagram& d) { d.sequence = 0; }},
      {"measured", [](StateDatagram& d) { d.measured = -1; }},
      {"position", [](StateDatagram& d) { d.position[0] = kNaN; }},
      {"velocity", [](StateDatagram& d) { d.velocity[1] = kInfinity; }},
      {"max_force", [](StateDatagram& d) { d.max_force = -1; }},
      {"max_force", [](StateDatagram& d) { d.max_force = kNaN; }},
      {"max_stiffness", [](StateDatagram& d) { d.max_stiffness = kInfinity; }},
      {"box_min", [](StateDatagram& d) { d.box_min[2] = -kInfinity; }},
      {"box_max", [](StateDatagram& d) { d.box_max[2] = kNaN; }},
  };
  EXPECT_TRUE(decode<StateDatagram>(encode(some_state_datagram())));
  for (const auto& [what, spoil] : cases) {
    StateDatagram d = some_state_datagram();
    spoil(d);
    EXPECT_FALSE(decode<StateDatagram>(encode(d))) << what;
  }
}

TEST(UdpProtocol, refuses_a_force_that_is_none) {
  using Spoil = void (*)(ForceDatagram&);
  const std::vector<std::pair<const char*, Spoil>> cases = {
      {"magic", [](ForceDatagram& d) { d.magic = kStateMagic; }},
      {"version", [](ForceDatagram& d) { d.version = 0; }},
      {"flags", [](ForceDatagram& d) { d.flags = 2; }},
      {"sequence", [](ForceDatagram& d) { d.sequence = 0; }},
      {"sent", [](ForceDatagram& d) { d.sent = -1; }},
      {"x", [](ForceDatagram& d) { d.force[0] = kNaN; }},
      {"y", [](ForceDatagram& d) { d.force[1] = -kInfinity; }},
      {"z", [](ForceDatagram& d) { d.force[2] = kInfinity; }},
  };
  EXPECT_TRUE(decode<ForceDatagram>(encode(some_force_datagram())));
  for (const auto& [what, spoil] : cases) {
    ForceDatagram d = some_force_datagram();
    spoil(d);
    EXPECT_FALSE(decode<ForceDatagram>(encode(d))) << what;
  }
}

TEST(UdpProtocol, refuses_any_other_size) {
  std::vector<std::byte> longer(1000);
  const auto state = encode(some_state_datagram());
  std::memcpy(longer.data(), state.data(), state.size());
  for (std::size_t size = 0; size <= longer.size(); ++size) {
    const std::span<const std::byte> bytes(longer.data(), size);
    EXPECT_EQ(decode<StateDatagram>(bytes).has_value(), size == state.size()) << size;
    EXPECT_FALSE(decode<ForceDatagram>(bytes)) << size;
  }
}

TEST(UdpProtocol, carries_an_orientation_and_a_torque) {
  test::FakeDevice device;
  device.turn();
  DeviceState state = some_state();
  state.orientation = Rotation(0.5, -0.5, 0.5, 0.5);
  const TurningStateDatagram sent = datagram_of(device.info(), state, 42);
  const auto got = decode<TurningStateDatagram>(encode(sent));
  ASSERT_TRUE(got);
  EXPECT_EQ(state_of(*got).orientation.coeffs(), state.orientation.coeffs());
  const DeviceInfo told = info_of(*got, true, "");
  EXPECT_TRUE(told.has_orientation);
  EXPECT_EQ(told.max_torque, 0.2);
  EXPECT_FALSE(decode<StateDatagram>(encode(sent)));
  const auto spoilt = [&](double w, double most) {
    TurningStateDatagram d = sent;
    d.orientation[0] = w;
    d.max_torque = most;
    return !decode<TurningStateDatagram>(encode(d));
  };
  EXPECT_FALSE(spoilt(0.5, 0));
  for (const double w : {0.0, 0.6, 2.0, kNaN, kInfinity}) EXPECT_TRUE(spoilt(w, 0)) << w;
  for (const double most : {-1.0, kNaN, kInfinity}) EXPECT_TRUE(spoilt(0.5, most)) << most;
  WrenchDatagram wrench{some_force_datagram(), {1, 2, 3}};
  EXPECT_TRUE(decode<WrenchDatagram>(encode(wrench)));
  EXPECT_EQ(encode(wrench).size(), 80u);
  EXPECT_EQ(encode(sent).size(), 184u);
  wrench.torque[1] = kNaN;
  EXPECT_FALSE(decode<WrenchDatagram>(encode(wrench)));
}

// A position that is NaN, a device that has not measured yet.
TEST(UdpProtocol, makes_no_datagram_of_a_state_that_is_none) {
  DeviceState state = some_state();
  state.position.y() = kNaN;
  EXPECT_FALSE(is_valid(datagram_of({}, state, 42)));
  EXPECT_FALSE(is_valid(datagram_of({}, {}, 42)));
}

}  // namespace
}  // namespace gliss::udp
