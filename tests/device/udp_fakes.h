// The ends of the UDP protocol as tests play them.
#pragma once

#include <atomic>
#include <optional>

#include "gliss/device/udp_server.h"

namespace gliss::test {

// A device that measures in every read and remembers its force.
class FakeDevice : public HapticDevice {
 public:
  FakeDevice() {
    info_.name = "fake";
    info_.max_force = 3;
    info_.max_stiffness = 700;
    info_.workspace = {Vec3(-0.1, -0.2, -0.3), Vec3(0.4, 0.5, 0.6)};
    info_.has_velocity = true;
  }

  static Vec3 position(std::uint64_t sequence) {
    return {0.1 / static_cast<double>(sequence), 0.01, static_cast<double>(sequence)};
  }

  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceState read(Nanoseconds now) noexcept override {
    ++state.sequence;
    state.measured = now;
    state.position = position(state.sequence);
    state.velocity = Vec3(1, 2, 3);
    return state;
  }
  bool write(const Vec3& force, Nanoseconds) noexcept override {
    last = force;
    size = force.norm();
    return accepts;
  }
  bool write_wrench(const Wrench& wrench, Nanoseconds now) noexcept override {
    torque = wrench.torque;
    return write(wrench.force, now);
  }
  // It has an orientation, half a turn about y, and motors for a torque.
  void turn() {
    info_.has_orientation = true;
    info_.max_torque = 0.2;
    state.orientation = Rotation(0, 0, 1, 0);
  }

  DeviceState state;
  Vec3 torque = Vec3(9, 9, 9);
  Vec3 last = Vec3(9, 9, 9);
  std::atomic<double> size{9};  // of it, for other threads
  bool accepts = true;

 protected:
  DeviceInfo info_;
};

// One end that sends what it likes.
class Peer {
 public:
  explicit Peer(std::uint16_t to = 0, std::uint16_t on = 0) : socket(on) {
    if (to != 0) socket.connect(to);
  }
  // A loop of whom this server serves.
  explicit Peer(const UdpServer& server) : Peer(server.port()) { pass = server.pass(); }

  void force(const Vec3& force, std::uint64_t sequence, Nanoseconds sent, std::uint16_t flags = 0) {
    udp::ForceDatagram d;
    d.flags = flags;
    d.sequence = sequence;
    d.answers = 77;
    d.sent = sent.count();
    d.force = udp::triple(force);
    if (pass) {
      socket.send(udp::encode(udp::PassedForceDatagram{d, *pass}));
    } else {
      socket.send(udp::encode(d));
    }
  }
  void state(std::uint64_t sequence, std::uint64_t session = 1, std::uint16_t flags = 0) {
    DeviceState state;
    state.sequence = sequence;
    state.measured = monotonic_time() + ahead;
    state.position = FakeDevice::position(sequence);
    udp::StateDatagram d = udp::datagram_of({}, state, session).state;
    d.flags |= flags;
    socket.send(udp::encode(d));
  }
  // Everything that a datagram could be and is not.
  void garbage() {
    std::array<std::byte, udp::kLargest + 1> bytes{};
    for (std::size_t size = 0; size <= bytes.size(); ++size) socket.send({bytes.data(), size});
  }

  // The next that arrived, of this kind and valid.
  template <class Datagram>
  std::optional<Datagram> receive() {
    std::array<std::byte, sizeof(Datagram)> bytes;
    const udp::Arrival arrival = socket.receive(bytes);
    refused = arrival.outcome == udp::Outcome::kRefused;
    from = arrival.port;
    if (arrival.size != bytes.size()) return std::nullopt;
    return udp::decode<Datagram>(bytes);
  }

  udp::Socket socket;
  std::optional<udp::Pass> pass;
  Nanoseconds ahead{};     // its clock's
  bool refused = false;    // by the last receive()
  std::uint16_t from = 0;  // of it
};

}  // namespace gliss::test
