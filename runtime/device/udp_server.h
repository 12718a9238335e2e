// The other side of gliss/device/udp_device.h: gives a haptic device of this process to one loop
// in another. The device has no force unless that loop sent one in the last 20 ms, and then what a
// guard of its own lets through. The force of a loop that dies, says bye or is ended fades by that
// guard. What does not bring the pass of this user (gliss/device/udp_pass.h) is refused.
#pragma once

#include <functional>
#include <optional>

#include "gliss/base/export.h"
#include "gliss/device/device.h"
#include "gliss/device/guard.h"
#include "gliss/device/udp_pass.h"
#include "gliss/device/udp_protocol.h"
#include "gliss/device/udp_socket.h"

namespace gliss {

struct UdpServerOptions {
  Nanoseconds period = std::chrono::milliseconds(1);
  // A force is gone this long after it was sent: at most 20 ms, which a HapticDevice owes, and more
  // than a period, because the last tick before takes it away.
  Nanoseconds watchdog = std::chrono::milliseconds(20);
  // Between the loop's force and the device, which may limit it further. It starts anew with each
  // loop, and engages again by itself where a loop that was late or silent asks for little force.
  // None: the loop's own guard is all there is, and the device's largest force.
  std::optional<GuardLimits> guard = GuardLimits{};
  // The device is neither read nor written before the first loop comes: a hand that follows a path
  // begins it then.
  bool waits = false;
};

struct UdpServerCounts {
  std::uint64_t received = 0;        // datagrams that the loop sent
  std::uint64_t sent = 0;            // to it
  std::uint64_t rejected = 0;        // are not of this protocol, or were sent after they arrived
  std::uint64_t refused = 0;         // bring no pass, or another
  std::uint64_t ignored = 0;         // a stranger's, or too old
  std::uint64_t peers = 0;           // loops that came, or came back from silence
  std::uint64_t watchdog_trips = 0;  // loops that went silent
  std::uint64_t lost = 0;            // loops whose process was found dead
  std::uint64_t answered = 0;        // sequence of the state that the last force answers
};

// One thread's. The device must outlive it. The loop that sends first has the device until it says
// bye, dies, or is silent for udp::kPlaceKept; others are refused as if nobody were here.
class GLISS_EXPORT UdpServer {
 public:
  static constexpr int kDrain = 64;  // datagrams that one tick takes at most

  // Port 0: any that is free. Throws LoopError where the port or its pass cannot be had,
  // std::invalid_argument for invalid options.
  UdpServer(HapticDevice& device, std::uint16_t port, const UdpServerOptions& options = {});
  ~UdpServer();
  UdpServer(const UdpServer&) = delete;
  UdpServer& operator=(const UdpServer&) = delete;

  std::uint16_t port() const noexcept { return socket_.port(); }
  const udp::Pass& pass() const noexcept { return pass_.value(); }

  // Ticks until `stop`, asked before each, says so, and until the force has faded. However it ends,
  // the device has no force then and the loop is told that nothing comes after.
  void run(const std::function<bool()>& stop);

  // One tick at `now`, of CLOCK_MONOTONIC, never backwards; it does not wait, and allocates
  // nothing but where it writes a pass again for a loop that was refused.
  void step(Nanoseconds now) noexcept;
  void end() noexcept;  // at once: no force, and the loop is told

  const UdpServerCounts& counts() const noexcept { return counts_; }

 private:
  void publish(Nanoseconds now) noexcept;
  void receive(Nanoseconds now) noexcept;
  void take(const udp::WrenchDatagram& datagram, std::uint16_t port, Nanoseconds now) noexcept;
  udp::Outcome send_state() noexcept;
  void join(std::uint16_t port) noexcept;
  void let_go() noexcept;
  void say_end() noexcept;
  Wrench guarded(Nanoseconds now) noexcept;
  bool late(Nanoseconds sent, Nanoseconds now) const noexcept;

  HapticDevice& device_;
  UdpServerOptions options_;
  udp::Socket socket_;
  udp::OwnPass pass_;
  std::uint64_t session_;
  udp::TurningStateDatagram last_;  // that was sent
  std::uint16_t peer_ = 0;          // its port, 0: there is none
  std::uint64_t newest_ = 0;        // sequence of its last force
  Nanoseconds heard_{};             // when it sent that
  bool silent_ = false;             // it is, and has no force
  Wrench wrench_;
  std::optional<Guard> guard_;  // where there is a peer, or was one whose force fades
  Nanoseconds now_{};
  bool written_ = true;
  UdpServerCounts counts_;
};

}  // namespace gliss
