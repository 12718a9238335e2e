#include "gliss/device/udp_device.h"

#include <algorithm>
#include <stdexcept>

#include "gliss/base/message.h"
#include "gliss/thread/realtime.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kHelloEvery = 5ms;  // the server forgets a loop that is silent for 20 ms
constexpr int kByes = 3;                  // a datagram may be lost

// Seconds, with one digit after the point.
std::string tenths(Nanoseconds time) {
  using Tenths = std::chrono::duration<std::int64_t, std::deci>;
  const std::int64_t count = std::chrono::round<Tenths>(time).count();
  return detail::message(count / 10, ".", count % 10);
}

}  // namespace

UdpDevice::UdpDevice(std::uint16_t port, Nanoseconds patience) : port_(port) {
  if (port == 0) throw std::invalid_argument("a device's UDP port must be 1 to 65535");
  open_socket();
  const Nanoseconds start = monotonic_time();
  while (state_.sequence == 0) {
    const auto found = udp::find_pass(port);
    const Nanoseconds now = monotonic_time();  // a hello is as old as it is when it goes out
    const bool is_same = found ? pass_ && pass_->pass == found->pass : !pass_;
    if (!is_same) {
      open_socket();
    } else if (refused_) {
      throw LoopError(detail::message(
          "udp:", port, ": the device at 127.0.0.1:", port, " refused this loop, for it lacks the ",
          "pass; ", found ? "another one" : "none", " was found in ", udp::pass_paths(port),
          "; cure: run it as the user who serves the device"));
    }
    pass_ = found;
    if (now - start > patience) {
      if (rejected_ > 0)
        throw LoopError(
            detail::message("udp:", port, ": ", rejected_, " datagrams came from 127.0.0.1:", port,
                            ", and none was a state that was measured before it arrived; cure: let "
                            "the device stamp its states by CLOCK_MONOTONIC"));
      throw LoopError(
          pass_ && pass_->served
              ? detail::message("udp:", port,
                                ": the device refused this loop, for another has it, or had it a "
                                "moment ago; cure: end that, and wait for ",
                                std::chrono::seconds(udp::kPlaceKept).count(), " s")
              : detail::message("udp:", port, ": no haptic device answered at 127.0.0.1:", port,
                                " for ", tenths(patience),
                                " s; cure: start the device's program or gliss serve with this "
                                "port, or end the loop that uses it already"));
    }
    send({}, now, 0);
    // A refusal ends a wait at once, and is to be waited for, not to be spun on.
    for (const Nanoseconds next = now + kHelloEvery; state_.sequence == 0;) {
      const Nanoseconds left = next - monotonic_time();
      if (left <= 0ns) break;
      socket_->wait(left);
      receive();
    }
  }
  info_ = udp::info_of(last_, has_orientation_, detail::message("udp:", port));
}

UdpDevice::~UdpDevice() {
  for (int i = 0; i < kByes; ++i) send({}, monotonic_time(), udp::kBye);
}

void UdpDevice::open_socket() {
  socket_.emplace().connect(port_);
  refused_ = false;
}

DeviceState UdpDevice::read(Nanoseconds now) noexcept {
  receive();
  DeviceState state = state_;
  state.measured = std::min(state.measured, now);
  return state;
}

bool UdpDevice::write_wrench(const Wrench& wrench, Nanoseconds now) noexcept {
  return send(wrench, now, 0) && !unreachable_ && !refused_;
}

std::string UdpDevice::fault_text() const {
  if (refused_) return "the device refuses this loop: it was served anew";
  if (!unreachable_) return HapticDevice::fault_text();
  const auto pass = udp::find_pass(port_);
  return pass && pass->served ? "the device refuses this loop: another has it"
                              : "the device's process has ended";
}

void UdpDevice::receive() noexcept {
  const auto dead = [&] { unreachable_ = true; };
  udp::drain<udp::kLargest>(*socket_, kDrain, dead, [&](auto bytes, std::uint16_t) {
    auto datagram = udp::decode<udp::TurningStateDatagram>(bytes);
    const bool has_orientation = datagram.has_value();
    if (const auto state = udp::decode<udp::StateDatagram>(bytes))
      datagram.emplace().state = *state;
    if (datagram && Nanoseconds(datagram->state.measured) <= monotonic_time()) {
      take(*datagram, has_orientation);
    } else if (udp::decode<udp::RefusalDatagram>(bytes)) {
      refused_ = true;
    } else {
      ++rejected_;
    }
  });
}

// The same sequence again may carry other flags.
void UdpDevice::take(const udp::TurningStateDatagram& turning, bool has_orientation) noexcept {
  const udp::StateDatagram &datagram = turning.state, &last = last_.state;
  const bool older = datagram.session == last.session ? datagram.sequence < last.sequence
                                                      : datagram.session < last.session;
  if (older) {
    ++outdated_;
    return;
  }
  if (datagram.session != last.session) before_ = state_.sequence;
  state_ = udp::state_of(turning);
  state_.sequence = before_ + datagram.sequence;
  last_ = turning;
  has_orientation_ = has_orientation;
  unreachable_ = refused_ = false;
}

bool UdpDevice::send(const Wrench& given, Nanoseconds now, std::uint16_t flags) noexcept {
  udp::WrenchDatagram wrench;
  udp::ForceDatagram& datagram = wrench.force;
  datagram.flags = flags;
  datagram.sequence = ++sent_;
  datagram.answers = last_.state.sequence;
  datagram.sent = std::max(now, 0ns).count();
  if (const udp::Triple wanted = udp::triple(given.force); udp::is_finite(wanted))
    datagram.force = wanted;
  if (const udp::Triple wanted = udp::triple(given.torque); udp::is_finite(wanted))
    wrench.torque = wanted;
  const udp::Pass* pass = pass_ ? &pass_->pass : nullptr;
  const udp::Outcome outcome =
      has_orientation_
          ? (pass ? socket_->send(udp::encode(udp::PassedWrenchDatagram{wrench, *pass}))
                  : socket_->send(udp::encode(wrench)))
          : (pass ? socket_->send(udp::encode(udp::PassedForceDatagram{datagram, *pass}))
                  : socket_->send(udp::encode(datagram)));
  if (outcome == udp::Outcome::kRefused) unreachable_ = true;
  return outcome == udp::Outcome::kDone;
}

}  // namespace gliss
