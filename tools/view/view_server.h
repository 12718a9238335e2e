// The server of gliss view: one page and its socket, on 127.0.0.1 alone.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/view/view_protocol.h"

namespace gliss::tools {

// A message to pages, which share its bytes.
struct ViewPayload {
  bool is_text = true;
  std::string bytes;
};
using SharedPayload = std::shared_ptr<const ViewPayload>;

// The questions of a server to its program; all are called in run_for().
struct ViewEvents {
  // Tells a page that has come all that it needs to begin. True: it steers.
  std::function<std::vector<SharedPayload>(bool steers)> greet;
  // A message of the page that steers. Those of others are dropped.
  std::function<void(const ViewMessage&)> message;
  // A page that watched steers from now on.
  std::function<SharedPayload()> promote;
};

// A server on 127.0.0.1, one thread's. The first page steers, and once it has gone the one that has
// waited longest; all others watch. A page that sends too much, too often or what makes no sense is
// closed.
class ViewServer {
 public:
  static constexpr std::size_t kMostConnections = 16;
  static constexpr std::size_t kMostWaiting = 256;  // payloads for one page
  static constexpr std::chrono::seconds kHandshake{5}, kIdle{30};

  struct Counts {
    std::uint64_t pages = 0, refused = 0;  // handshakes that were answered with 400 to 405
    std::uint64_t closed = 0;              // pages, for what they sent or did not take
    std::uint64_t frames_lost = 0;         // that a slow page had no time for
  };

  // Port 0: any free one. `page`: an HTML text with its Content-Security-Policy in a meta element,
  // which becomes a header too. Throws LoopError where the port is taken.
  ViewServer(std::uint16_t port, std::string page, std::string token, ViewEvents events);
  ~ViewServer();  // closes all pages
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  std::uint16_t port() const;
  std::string url() const;  // with the token, in its fragment: a browser tells it nobody
  // Serves, and returns after that time or shortly before.
  void run_for(std::chrono::milliseconds time);
  // Sends to all pages, in order. A page that has not taken kMostWaiting of them is closed.
  void send(const SharedPayload& payload);
  // Sends to the pages that have taken all before it; the others lose it.
  void send_frame(const SharedPayload& payload);
  std::size_t watching() const;  // pages, with the one that steers
  const Counts& counts() const;

 private:
  struct State;
  class Connection;
  std::shared_ptr<State> state_;
};

// The policy of a page's meta element; "default-src 'none'" where there is none.
std::string policy_of(const std::string& page);

}  // namespace gliss::tools
