// A UDP socket of the loopback interface, 127.0.0.1 alone, that never waits unless told to. It
// neither allocates nor throws once it is open.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "gliss/base/export.h"
#include "gliss/thread/clock.h"

namespace gliss::udp {

enum class Outcome : std::uint8_t {
  kDone,
  kRefused,  // nobody has the other end's port any more: its process ended
  kNothing,  // nothing arrived, no room to send
};

struct Arrival {
  Outcome outcome = Outcome::kNothing;
  std::size_t size = 0;    // of the datagram, of which the buffer may hold only the beginning
  std::uint16_t port = 0;  // of its sender
};

class GLISS_EXPORT Socket {
 public:
  // Takes a port, which disconnect() keeps; 0: any that is free. Throws LoopError.
  explicit Socket(std::uint16_t port = 0);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  std::uint16_t port() const noexcept { return port_; }

  // Sends there; nobody else's datagrams arrive from now on, but those that wait already do.
  // Strangers are refused as if nobody were here.
  bool connect(std::uint16_t port) noexcept;
  void disconnect() noexcept;

  // A later call tells what an earlier datagram met.
  Outcome send(std::span<const std::byte> bytes) noexcept;
  void send_to(std::uint16_t port, std::span<const std::byte> bytes) noexcept;
  Arrival receive(std::span<std::byte> buffer) noexcept;
  // True when something may have arrived.
  bool wait(Nanoseconds timeout) noexcept;

 private:
  int descriptor_ = -1;
  std::uint16_t port_ = 0;
};

// Takes up to `most` datagrams that wait: take(bytes, port) each, without bytes where one is longer
// than kSize; dead() where the other end is found to be.
template <std::size_t kSize, class Dead, class Take>
void drain(Socket& socket, int most, Dead dead, Take take) noexcept {
  for (int i = 0; i < most; ++i) {
    std::array<std::byte, kSize> buffer;
    const Arrival arrival = socket.receive(buffer);
    if (arrival.outcome == Outcome::kNothing) return;
    if (arrival.outcome == Outcome::kRefused) {
      dead();
      continue;
    }
    const std::span<const std::byte> whole(buffer);
    take(whole.first(arrival.size <= kSize ? arrival.size : 0), arrival.port);
  }
}

}  // namespace gliss::udp
