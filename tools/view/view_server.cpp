#include "tools/view/view_server.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <optional>
#include <utility>

#include "gliss/thread/clock.h"
#include "gliss/thread/realtime.h"

namespace gliss::tools {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

const char* reason_of(ViewAnswer answer) {
  switch (answer) {
    case ViewAnswer::kPage:
    case ViewAnswer::kSocket:
      return "200 OK";
    case ViewAnswer::kForbidden:
      return "403 Forbidden";
    case ViewAnswer::kNotFound:
      return "404 Not Found";
    case ViewAnswer::kNotAllowed:
      return "405 Method Not Allowed";
    case ViewAnswer::kBadRequest:
      break;
  }
  return "400 Bad Request";
}

std::string response_of(ViewAnswer answer, const std::string& policy, std::size_t length) {
  const bool is_page = answer == ViewAnswer::kPage;
  return fmt::format(
      "HTTP/1.1 {}\r\nContent-Type: {}; charset=utf-8\r\nContent-Length: {}\r\n{}"
      "Content-Security-Policy: {}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'\r\n"
      "X-Frame-Options: DENY\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n"
      "Cache-Control: no-store\r\nConnection: close\r\n\r\n",
      reason_of(answer), is_page ? "text/html" : "text/plain", length,
      answer == ViewAnswer::kNotAllowed ? "Allow: GET, HEAD\r\n" : "", policy);
}

}  // namespace

struct ViewServer::State {
  State(std::string page_text, ViewEvents program)
      : page(std::move(page_text)), policy(policy_of(page)), events(std::move(program)) {}

  static void accept(const std::shared_ptr<State>& state);

  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};  // before the next accept where one failed
  ViewDoor door;
  std::string page, policy;
  ViewEvents events;
  Counts counts;
  bool ended = false;
  std::vector<std::shared_ptr<Connection>> open;   // all, those that only ask for the page too
  std::vector<std::shared_ptr<Connection>> pages;  // with a socket; the first one steers
};

// From its accept to its end. All handlers keep it alive.
class ViewServer::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(std::shared_ptr<State> state, tcp::socket socket)
      : state_(std::move(state)), socket_(std::move(socket)) {}

  void start() {
    error_code ignored;
    stream().socket().set_option(tcp::no_delay(true), ignored);
    stream().expires_after(kHandshake);
    asio::async_read_until(stream(), asio::dynamic_buffer(head_, kLongestHead), "\r\n\r\n",
                           [self = shared_from_this()](const error_code& error, std::size_t size) {
                             if (error == asio::error::not_found) return self->refuse({});
                             if (error) return self->end();
                             self->judge(size);
                           });
  }

  void send(const SharedPayload& payload) {
    if (dropped_) return;
    if (waiting_.size() >= kMostWaiting) return drop(websocket::close_code::try_again_later);
    waiting_.push_back(payload);
    if (!writing_) write();
  }
  void send_frame(const SharedPayload& payload) {
    if (writing_) {
      ++state_->counts.frames_lost;
    } else {
      send(payload);
    }
  }

  void end() {
    error_code ignored;
    stream().socket().close(ignored);
    State& state = *state_;
    const auto self = shared_from_this();
    std::erase(state.open, self);
    const bool steered = !state.pages.empty() && state.pages.front() == self;
    if (std::erase(state.pages, self) == 0 || state.ended) return;
    if (steered && !state.pages.empty()) state.pages.front()->send(state.events.promote());
  }

 private:
  beast::tcp_stream& stream() { return socket_.next_layer(); }

  void judge(std::size_t size) {
    const ViewJudgement judgement =
        judge_request(std::string_view(head_).substr(0, size), state_->door);
    if (judgement.answer == ViewAnswer::kSocket) return upgrade();
    refuse(judgement);
  }

  // The page, or why there is none.
  void refuse(const ViewJudgement& judgement) {
    const bool is_page = judgement.answer == ViewAnswer::kPage;
    const std::string body =
        is_page ? state_->page : std::string(reason_of(judgement.answer)) + "\n";
    answer_ = response_of(judgement.answer, state_->policy, body.size());
    if (!judgement.head_only) answer_ += body;
    if (!is_page) ++state_->counts.refused;
    asio::async_write(stream(), asio::buffer(answer_),
                      [self = shared_from_this()](const error_code&, std::size_t) {
                        error_code ignored;
                        self->stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
                        self->end();
                      });
  }

  void upgrade() {
    stream().expires_never();
    websocket::stream_base::timeout limits{kHandshake, kIdle, true};
    socket_.set_option(limits);
    socket_.set_option(websocket::stream_base::decorator([this](websocket::response_type& answer) {
      answer.set(beast::http::field::sec_websocket_protocol, "gliss." + state_->door.token);
    }));
    socket_.read_message_max(kLongestMessage);
    socket_.auto_fragment(false);
    socket_.async_accept(asio::buffer(head_), [self = shared_from_this()](const error_code& error) {
      if (error) return self->end();
      self->begin();
    });
  }

  void begin() {
    State& state = *state_;
    if (state.ended) return end();
    state.pages.push_back(shared_from_this());
    ++state.counts.pages;
    for (const SharedPayload& payload : state.events.greet(state.pages.size() == 1)) send(payload);
    read();
  }

  void read() {
    socket_.async_read(message_, [self = shared_from_this()](const error_code& error, std::size_t) {
      if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow)
        ++self->state_->counts.closed;
      if (error) return self->end();
      self->take();
    });
  }

  void take() {
    const auto data = message_.cdata();
    const std::string_view text(static_cast<const char*>(data.data()), data.size());
    const auto message = socket_.got_text() ? read_view_message(text) : std::nullopt;
    message_.clear();
    if (!message || !allowance_.take(in_seconds(monotonic_time())))
      return drop(websocket::close_code::policy_error);
    const auto& pages = state_->pages;
    if (!pages.empty() && pages.front().get() == this) state_->events.message(*message);
    read();
  }

  void write() {
    writing_ = true;
    const SharedPayload payload = waiting_.front();
    socket_.text(payload->is_text);
    socket_.async_write(asio::buffer(payload->bytes),
                        [self = shared_from_this(), payload](const error_code& error, std::size_t) {
                          if (error) return self->end();
                          self->waiting_.pop_front();
                          self->writing_ = false;
                          if (!self->waiting_.empty()) self->write();
                        });
  }

  // Closes a page for what it did: nothing of it is read any more.
  void drop(websocket::close_code why) {
    if (std::exchange(dropped_, true)) return;
    ++state_->counts.closed;
    socket_.async_close(why, [self = shared_from_this()](const error_code&) { self->end(); });
  }

  std::shared_ptr<State> state_;
  websocket::stream<beast::tcp_stream> socket_;
  std::string head_, answer_;
  beast::flat_buffer message_{kLongestMessage};
  MessageAllowance allowance_;
  std::deque<SharedPayload> waiting_;  // the first is being written
  bool writing_ = false, dropped_ = false;
};

void ViewServer::State::accept(const std::shared_ptr<State>& state) {
  state->acceptor.async_accept([state](const error_code& error, tcp::socket socket) {
    if (state->ended) return;
    if (error) {  // no descriptors, say
      state->pause.expires_after(std::chrono::milliseconds(100));
      state->pause.async_wait([state](const error_code&) {
        if (!state->ended) accept(state);
      });
      return;
    }
    if (state->open.size() < kMostConnections) {
      const auto connection = std::make_shared<Connection>(state, std::move(socket));
      state->open.push_back(connection);
      connection->start();
    }
    accept(state);
  });
}

ViewServer::ViewServer(std::uint16_t port, std::string page, std::string token, ViewEvents events)
    : state_(std::make_shared<State>(std::move(page), std::move(events))) {
  const tcp::endpoint here(asio::ip::address_v4::loopback(), port);
  error_code error;
  state_->acceptor.open(here.protocol(), error);
  // One that has just ended leaves its port to the next.
  if (!error) state_->acceptor.set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) state_->acceptor.bind(here, error);
  if (!error) state_->acceptor.listen(16, error);
  if (error)
    throw LoopError(fmt::format("view: port {} of 127.0.0.1: {}; cure: --port 0 takes a free one",
                                port, error.message()));
  state_->door = {state_->acceptor.local_endpoint().port(), std::move(token)};
  State::accept(state_);
}

ViewServer::~ViewServer() {
  state_->ended = true;
  error_code ignored;
  state_->acceptor.close(ignored);
  state_->pause.cancel();
  const auto open = state_->open;
  for (const auto& connection : open) connection->end();
  // The sockets end what was under way.
  state_->io.restart();
  state_->io.run_for(std::chrono::milliseconds(100));
}

std::uint16_t ViewServer::port() const { return state_->door.port; }

std::string ViewServer::url() const {
  return fmt::format("http://127.0.0.1:{}/#{}", state_->door.port, state_->door.token);
}

void ViewServer::run_for(std::chrono::milliseconds time) {
  state_->io.restart();
  state_->io.run_for(time);
}

void ViewServer::send(const SharedPayload& payload) {
  const auto pages = state_->pages;
  for (const auto& page : pages) page->send(payload);
}

void ViewServer::send_frame(const SharedPayload& payload) {
  const auto pages = state_->pages;
  for (const auto& page : pages) page->send_frame(payload);
}

std::size_t ViewServer::watching() const { return state_->pages.size(); }
const ViewServer::Counts& ViewServer::counts() const { return state_->counts; }

std::string policy_of(const std::string& page) {
  constexpr std::string_view kMark = "http-equiv=\"Content-Security-Policy\"",
                             kContent = "content=\"";
  const auto meta = page.find(kMark);
  const auto begin = meta == std::string::npos ? meta : page.find(kContent, meta);
  if (begin == std::string::npos) return "default-src 'none'";
  const auto from = begin + kContent.size();
  return page.substr(from, page.find('"', from) - from);
}

}  // namespace gliss::tools
