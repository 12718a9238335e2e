#include "gliss/device/udp_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "gliss/base/message.h"
#include "gliss/thread/realtime.h"

namespace gliss::udp {
namespace {

constexpr int kPortTries = 16;

sockaddr_in loopback(std::uint16_t port) noexcept {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

// A bound socket, or -1 and errno.
int open_on(std::uint16_t port) noexcept {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  const sockaddr_in address = loopback(port);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return descriptor;
  }
  const int error = errno;
  close(descriptor);
  errno = error;
  return -1;
}

std::uint16_t port_of(int descriptor) noexcept {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

Outcome failed() noexcept { return errno == ECONNREFUSED ? Outcome::kRefused : Outcome::kNothing; }

}  // namespace

Socket::Socket(std::uint16_t port) : descriptor_(open_on(port)), port_(port) {
  // A port that the kernel chose is lost by disconnecting, one that was asked for stays.
  for (int i = 0; port == 0 && descriptor_ >= 0 && i < kPortTries; ++i) {
    port_ = port_of(descriptor_);
    close(descriptor_);
    descriptor_ = open_on(port_);
    if (descriptor_ >= 0) return;
    descriptor_ = open_on(0);
  }
  if (descriptor_ >= 0 && port != 0) return;
  const int error = errno;
  if (descriptor_ >= 0) close(descriptor_);
  throw LoopError(detail::message(
      "udp:", port, ": port ", port, " of 127.0.0.1 cannot be used (", std::strerror(error),
      "); cure: ",
      error == EADDRINUSE ? "end the program that has it, or another port" : "another port"));
}

Socket::~Socket() { close(descriptor_); }

bool Socket::connect(std::uint16_t port) noexcept {
  const sockaddr_in address = loopback(port);
  return ::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

void Socket::disconnect() noexcept {
  sockaddr nobody{};
  nobody.sa_family = AF_UNSPEC;
  ::connect(descriptor_, &nobody, sizeof nobody);
}

Outcome Socket::send(std::span<const std::byte> bytes) noexcept {
  const ssize_t sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(bytes.size()) ? Outcome::kDone : failed();
}

void Socket::send_to(std::uint16_t port, std::span<const std::byte> bytes) noexcept {
  const sockaddr_in address = loopback(port);
  (void)!sendto(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
                reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

Arrival Socket::receive(std::span<std::byte> buffer) noexcept {
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t got = recvfrom(descriptor_, buffer.data(), buffer.size(), MSG_TRUNC,
                               reinterpret_cast<sockaddr*>(&from), &size);
  if (got < 0) return {.outcome = failed()};
  const bool ours = from.sin_addr.s_addr == htonl(INADDR_LOOPBACK);
  return {Outcome::kDone, static_cast<std::size_t>(got),
          ours ? ntohs(from.sin_port) : std::uint16_t{0}};
}

bool Socket::wait(Nanoseconds timeout) noexcept {
  pollfd ready{descriptor_, POLLIN, 0};
  const auto whole = std::chrono::ceil<std::chrono::milliseconds>(timeout).count();
  return poll(&ready, 1, static_cast<int>(whole)) > 0;
}

}  // namespace gliss::udp
