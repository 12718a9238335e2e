#include "runtime/udp_server.h"

#include <algorithm>
#include <stdexcept>

#include "runtime/guard.h"
#include "runtime/periodic.h"

namespace gliss {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kLongestWatchdog = 20ms;
constexpr int kFarewells = 3;  // a datagram may be lost

UdpServerOptions checked(const UdpServerOptions& options) {
  if (options.watchdog <= 0ns || options.watchdog > kLongestWatchdog)
    throw std::invalid_argument("watchdog: must be positive and at most 20 ms");
  if (options.period <= 0ns || options.period >= options.watchdog)
    throw std::invalid_argument("period: must be positive and shorter than the watchdog");
  return options;
}

}  // namespace

UdpServer::UdpServer(HapticDevice& device, std::uint16_t port, const UdpServerOptions& options)
    : device_(device),
      options_(checked(options)),
      socket_(port),
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
}

// The state goes out first: what became of the loop since is then known when its force is decided.
void UdpServer::step(Nanoseconds now) noexcept {
  now_ = now;
  publish(now);
  receive(now);
  if (peer_ != 0 && late(heard_, now)) {
    ++counts_.watchdog_trips;
    forget();
  }
  written_ = device_.write(force_, now);
}

void UdpServer::end() noexcept {
  const Nanoseconds now = std::max(now_, monotonic_time());
  device_.write(Vec3::Zero(), now);
  if (peer_ == 0) return;
  last_.flags |= udp::kEnded;
  for (int i = 0; i < kFarewells && last_.sequence > 0; ++i) socket_.send(udp::encode(last_));
  forget();
}

void UdpServer::publish(Nanoseconds now) noexcept {
  DeviceState state = device_.read(now);
  if (peer_ == 0) return;
  state.fault = state.fault || !written_;
  const udp::StateDatagram datagram = udp::datagram_of(device_.info(), state, session_);
  // The loop sees the states age, as it does where there is none.
  if (!udp::is_valid(datagram)) return;
  last_ = datagram;
  const udp::Outcome outcome = socket_.send(udp::encode(datagram));
  if (outcome == udp::Outcome::kDone) ++counts_.sent;
  if (outcome == udp::Outcome::kRefused) {
    ++counts_.lost;
    forget();
  }
}

void UdpServer::receive(Nanoseconds now) noexcept {
  const auto dead = [&] {
    if (peer_ != 0) ++counts_.lost;
    forget();
  };
  udp::drain<udp::kLargest>(socket_, kDrain, dead, [&](auto bytes, std::uint16_t port) {
    const auto datagram = udp::decode<udp::ForceDatagram>(bytes);
    if (datagram && port != 0) {
      take(*datagram, port, now);
    } else {
      ++counts_.rejected;
    }
  });
}

// A process that stood still finds the oldest datagrams in its queue: when they were sent counts,
// not when they are read.
void UdpServer::take(const udp::ForceDatagram& datagram, std::uint16_t port,
                     Nanoseconds now) noexcept {
  const Nanoseconds sent = std::min(Nanoseconds(datagram.sent), now);
  const bool bye = (datagram.flags & udp::kBye) != 0;
  const bool old = late(sent, now);
  const bool known = peer_ != 0 && port == peer_ && datagram.sequence > newest_;
  const bool joins = peer_ == 0 && !bye && !old;
  if ((!known && !joins) || (old && !bye)) {
    ++counts_.ignored;
    return;
  }
  ++counts_.received;
  if (bye) return forget();
  if (joins) {
    if (!socket_.connect(port)) return;
    ++counts_.peers;
    peer_ = port;
  }
  newest_ = datagram.sequence;
  heard_ = sent;
  counts_.answered = datagram.answers;
  force_ =
      motor_force(udp::vector(datagram.force), device_.info().max_force).value_or(Vec3::Zero());
}

// A tick later would be too late.
bool UdpServer::late(Nanoseconds sent, Nanoseconds now) const noexcept {
  return now - sent > options_.watchdog - options_.period;
}

// No force without a loop.
void UdpServer::forget() noexcept {
  force_ = Vec3::Zero();
  if (peer_ == 0) return;
  peer_ = 0;
  newest_ = 0;
  socket_.disconnect();
}

}  // namespace gliss
