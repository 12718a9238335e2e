// A haptic device that lives in another process of this machine (gliss/device/udp_server.h serves
// one) and speaks gliss/device/udp_protocol.h. Where that has a pass (gliss/device/udp_pass.h),
// each force brings it.
#pragma once

#include <optional>

#include "gliss/base/export.h"
#include "gliss/device/device.h"
#include "gliss/device/udp_pass.h"
#include "gliss/device/udp_protocol.h"
#include "gliss/device/udp_socket.h"

namespace gliss {

class GLISS_EXPORT UdpDevice final : public HapticDevice {
 public:
  static constexpr int kDrain = 64;  // datagrams that one read() takes at most

  // Asks at 127.0.0.1:port until the first state arrives. Throws LoopError where none does within
  // `patience` or the device refuses this loop, std::invalid_argument for port 0.
  explicit UdpDevice(std::uint16_t port, Nanoseconds patience = std::chrono::seconds(2));
  ~UdpDevice() override;  // says zero and bye
  UdpDevice(const UdpDevice&) = delete;
  UdpDevice& operator=(const UdpDevice&) = delete;

  const DeviceInfo& info() const noexcept override { return info_; }
  // A device whose process stands still or died is one whose states age. One that was started again
  // goes on with new states if it asks for no pass; `gliss serve` has another pass then, refuses
  // this loop, and fault_text() says so.
  DeviceState read(Nanoseconds now) noexcept override;
  // `now` is CLOCK_MONOTONIC's. A force or torque that is not finite goes out as
  // zero. False too from when
  // the device's process is known to have died until a state arrives.
  bool write(const Vec3& force, Nanoseconds now) noexcept override {
    return write_wrench({force, Vec3::Zero()}, now);
  }
  bool write_wrench(const Wrench& wrench, Nanoseconds now) noexcept override;
  std::string fault_text() const override;

  // Datagrams that are not of this protocol, or say that they were measured after they arrived.
  std::uint64_t rejected() const noexcept { return rejected_; }
  std::uint64_t outdated() const noexcept { return outdated_; }  // states older than one before

 private:
  // Opens a socket for each pass that is asked with. A server that has its pass refuses what was
  // asked before; on another socket nobody hears that.
  void open_socket();
  void receive() noexcept;
  void take(const udp::TurningStateDatagram& datagram, bool has_orientation) noexcept;
  bool send(const Wrench& wrench, Nanoseconds now, std::uint16_t flags) noexcept;

  std::uint16_t port_;
  std::optional<udp::Socket> socket_;  // always has one
  std::optional<udp::FoundPass> pass_;
  DeviceInfo info_;
  udp::TurningStateDatagram last_;
  bool has_orientation_ = false;  // it came with an orientation
  DeviceState state_;
  std::uint64_t before_ = 0;  // sequence that the sessions before this one reached
  std::uint64_t sent_ = 0;
  bool unreachable_ = false, refused_ = false;
  std::uint64_t rejected_ = 0, outdated_ = 0;
};

}  // namespace gliss
