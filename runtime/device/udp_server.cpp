#include "gliss/device/udp_server.h"

#include <algorithm>
#include <stdexcept>

#include "gliss/thread/periodic.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kLongestWatchdog = 20ms;
constexpr int kFarewells = 3;  // a datagram may be lost

UdpServerOptions checked(UdpServerOptions options, const DeviceInfo& device) {
  if (options.watchdog <= 0ns || options.watchdog > kLongestWatchdog)
    throw std::invalid_argument("watchdog: must be positive and at most 20 ms");
  if (options.period <= 0ns || options.period >= options.watchdog)
    throw std::invalid_argument("period: must be positive and shorter than the watchdog");
  if (options.guard) {
    options.guard->max_force = std::min(options.guard->max_force, device.max_force);
    options.guard->max_torque = std::min(options.guard->max_torque, device.max_torque);
    Guard{*options.guard};  // checks them
  }
  return options;
}

// Takes the same time however much of them is the same.
bool is_same(const udp::Pass& a, const udp::Pass& b) {
  std::byte differ{0};
  for (std::size_t i = 0; i < a.size(); ++i) differ |= a[i] ^ b[i];
  return differ == std::byte{0};
}

}  // namespace

UdpServer::UdpServer(HapticDevice& device, std::uint16_t port, const UdpServerOptions& options)
    : device_(device),
      options_(checked(options, device.info())),
      socket_(port),
      pass_(socket_.port()),
      session_(static_cast<std::uint64_t>(monotonic_time().count())) {}

UdpServer::~UdpServer() { end(); }

void UdpServer::run(const std::function<bool()>& stop) {
  struct End {
    UdpServer& server;
    ~End() { server.end(); }
  } const end_of_run{*this};
  PeriodicTimer timer(options_.period);
  while (!stop()) {
    timer.wait();
    step(monotonic_time());
  }
  say_end();
  while (guard_) {  // what it has still let through
    timer.wait();
    step(monotonic_time());
  }
}

// The state goes out first: what became of the loop since is then known when its force is decided.
void UdpServer::step(Nanoseconds now) noexcept {
  now_ = now;
  if (options_.waits && counts_.peers == 0) return receive(now);
  publish(now);
  receive(now);
  if (peer_ != 0 && !silent_ && late(heard_, now)) {
    ++counts_.watchdog_trips;
    silent_ = true;
    wrench_ = {};
  }
  if (peer_ != 0 && now - heard_ > udp::kPlaceKept) let_go();
  written_ = device_.write_wrench(guarded(now), now);
}

Wrench UdpServer::guarded(Nanoseconds now) noexcept {
  if (!guard_) return wrench_;
  const GuardOutput out = guard_->step(now, {wrench_.force, heard_, wrench_.torque});
  if (peer_ == 0) {
    const bool is_over = out.state == GuardState::kSafe || late(heard_, now);
    if (is_over) guard_.reset();
    return is_over ? Wrench{} : Wrench{out.force, out.torque};
  }
  if (out.state == GuardState::kSafe && may_reengage(out.reason)) guard_->engage();
  return silent_ ? Wrench{} : Wrench{out.force, out.torque};
}

void UdpServer::end() noexcept {
  const Nanoseconds now = std::max(now_, monotonic_time());
  device_.write_wrench({}, now);
  say_end();
  guard_.reset();
}

void UdpServer::say_end() noexcept {
  if (peer_ == 0) return;
  last_.state.flags |= udp::kEnded;
  for (int i = 0; i < kFarewells && last_.state.sequence > 0; ++i) send_state();
  let_go();
}

udp::Outcome UdpServer::send_state() noexcept {
  return device_.info().has_orientation ? socket_.send(udp::encode(last_))
                                        : socket_.send(udp::encode(last_.state));
}

void UdpServer::publish(Nanoseconds now) noexcept {
  DeviceState state = device_.read(now);
  if (peer_ == 0) return;
  state.fault = state.fault || !written_;
  const udp::TurningStateDatagram datagram = udp::datagram_of(device_.info(), state, session_);
  // The loop sees the states age, as it does where there is none.
  if (!udp::is_valid(datagram)) return;
  last_ = datagram;
  const udp::Outcome outcome = send_state();
  if (outcome == udp::Outcome::kDone) ++counts_.sent;
  if (outcome == udp::Outcome::kRefused) {
    ++counts_.lost;
    let_go();
  }
}

void UdpServer::receive(Nanoseconds now) noexcept {
  const auto dead = [&] {
    if (peer_ != 0) ++counts_.lost;
    let_go();
  };
  udp::drain<udp::kLargest>(socket_, kDrain, dead, [&](auto bytes, std::uint16_t port) {
    auto passed = udp::decode<udp::PassedWrenchDatagram>(bytes);
    if (const auto force = udp::decode<udp::PassedForceDatagram>(bytes))
      passed = udp::PassedWrenchDatagram{{force->force, {}}, force->pass};
    const auto has_no_pass = [&] {
      return udp::decode<udp::ForceDatagram>(bytes) || udp::decode<udp::WrenchDatagram>(bytes);
    };
    if (passed && port != 0 && is_same(passed->pass, pass_.value())) {
      take(passed->wrench, port, now);
    } else if (port != 0 && (passed || has_no_pass())) {
      ++counts_.refused;
      if (peer_ == 0) {  // the loop looks for the pass again when it hears that
        pass_.keep();
        socket_.send_to(port, udp::encode(udp::RefusalDatagram{}));
      }
    } else {
      ++counts_.rejected;
    }
  });
}

// A process that stood still finds the oldest datagrams in its queue: when they were sent counts,
// not when they are read.
void UdpServer::take(const udp::WrenchDatagram& wrench, std::uint16_t port,
                     Nanoseconds now) noexcept {
  const udp::ForceDatagram& datagram = wrench.force;
  // This tick may be as late as that.
  if (Nanoseconds(datagram.sent) > now + options_.watchdog) {
    ++counts_.rejected;
    return;
  }
  const Nanoseconds sent = std::min(Nanoseconds(datagram.sent), now);
  const bool bye = (datagram.flags & udp::kBye) != 0;
  const bool old = late(sent, now);
  const bool known = peer_ != 0 && port == peer_ && datagram.sequence > newest_;
  const bool joins = peer_ == 0 && !guard_ && !bye && !old;
  if ((!known && !joins) || (old && !bye)) {
    ++counts_.ignored;
    return;
  }
  ++counts_.received;
  if (bye) return let_go();
  if (joins && !socket_.connect(port)) return;
  if (joins) join(port);
  if (joins || silent_) ++counts_.peers;
  silent_ = false;
  newest_ = datagram.sequence;
  heard_ = sent;
  counts_.answered = datagram.answers;
  const DeviceInfo& device = device_.info();
  wrench_ = {motor_force(udp::vector(datagram.force), device.max_force).value_or(Vec3::Zero()),
             motor_force(udp::vector(wrench.torque), device.max_torque).value_or(Vec3::Zero())};
}

// A tick later would be too late.
bool UdpServer::late(Nanoseconds sent, Nanoseconds now) const noexcept {
  return now - sent > options_.watchdog - options_.period;
}

void UdpServer::join(std::uint16_t port) noexcept {
  peer_ = port;
  if (options_.guard) guard_.emplace(*options_.guard);
}

// No force without a loop: a guard lets it fade, and the place is free once it has.
void UdpServer::let_go() noexcept {
  if (peer_ == 0) return;
  wrench_ = {};
  silent_ = false;
  if (guard_) guard_->trip(GuardReason::kStopRequested);
  peer_ = 0;
  socket_.disconnect();
}

}  // namespace gliss
