#include "gliss/haply/haply_link.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <optional>
#include <utility>

#include "gliss/haply/haply_protocol.h"
#include "gliss/thread/realtime.h"

namespace gliss {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

std::chrono::steady_clock::time_point instant(Nanoseconds monotonic) {
  return std::chrono::steady_clock::time_point(monotonic);
}

// A signal is for the program's other threads.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &old_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &old_, nullptr); }

 private:
  sigset_t old_;
};

}  // namespace

HaplyLink::HaplyLink(const HaplyOptions& options)
    : where_(fmt::format("haply: {}:{}", options.host, options.port)),
      device_id_(options.device_id),
      deadline_(std::chrono::steady_clock::now() + options.connect_timeout) {
  open(options);
  try {
    const HaplyState first = read_haply_state(text(), device_id_);
    device_id_ = first.device_id;
  } catch (const HaplyProtocolError& error) {
    throw LoopError(fmt::format("{} {}", where_, error.what()));
  }
  take_message();
  listen();
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { run(); });
  if (options.priority > 0) refused_ = set_realtime(thread_.native_handle(), options.priority);
}

HaplyLink::~HaplyLink() {
  asio::post(io_, [this] { close(); });  // not run where the link has failed
  thread_.join();
}

// Runs what is begun to its end, or throws at the deadline: then nothing of it runs any more.
template <class Start>
error_code HaplyLink::wait_for(const std::string& what, const Start& start) {
  std::optional<error_code> result;
  start([&result](const error_code& error, const auto&...) { result = error; });
  io_.restart();
  while (!result && io_.run_one_until(deadline_) > 0) {
  }
  if (!result) throw LoopError(fmt::format("{} {} in time", where_, what));
  return *result;
}

void HaplyLink::open(const HaplyOptions& options) {
  constexpr char kCure[] = "cure: start the Haply Inverse service, or name its host and port";
  tcp::resolver resolver(io_);
  tcp::resolver::results_type found;
  error_code error = wait_for("has an address that is not found", [&](const auto& done) {
    resolver.async_resolve(options.host, std::to_string(options.port),
                           [&found, done](const error_code& e, const auto& results) {
                             found = results;
                             done(e);
                           });
  });
  if (error)
    throw LoopError(fmt::format("{}: no such host ({}); {}", where_, error.message(), kCure));
  for (const auto& peer : found) {
    if (peer.endpoint().address().is_loopback()) continue;
    throw LoopError(
        fmt::format("{} is not this machine, and nothing protects states and forces on a network; "
                    "cure: ssh -L {}:localhost:{} {}, and haply:localhost:{}",
                    where_, options.port, options.port, options.host, options.port));
  }
  error = wait_for("does not accept a connection", [&](const auto& done) {
    asio::async_connect(socket_.next_layer(), found, done);
  });
  if (error) {
    throw LoopError(
        fmt::format("{}: nothing listens there ({}); {}", where_, error.message(), kCure));
  }
  socket_.next_layer().set_option(tcp::no_delay(true), error);
  socket_.read_message_max(HaplyDevice::kLargestMessage);
  error = wait_for("is not a WebSocket: it did not answer the handshake", [&](const auto& done) {
    socket_.async_handshake(fmt::format("{}:{}", options.host, options.port), "/", done);
  });
  if (error)
    throw LoopError(fmt::format("{} is not a WebSocket ({}); {}", where_, error.message(), kCure));
  error = wait_for("sent no state", [&](const auto& done) { socket_.async_read(buffer_, done); });
  if (error)
    throw LoopError(fmt::format("{} sent no state ({}); {}", where_, error.message(), kCure));
}

void HaplyLink::run() noexcept {
  prctl(PR_SET_TIMERSLACK, 1);
  try {
    io_.restart();
    io_.run();
  } catch (...) {  // no memory: the service takes the force away with the connection
    fail();
  }
}

void HaplyLink::listen() {
  socket_.async_read(buffer_, [this](const error_code& error, std::size_t) {
    if (error) return fail();
    take_message();
    listen();
  });
}

void HaplyLink::take_message() {
  const Nanoseconds now = monotonic_time();
  ++messages_;  // a malformed one is a measurement lost
  try {
    const HaplyState state = read_haply_state(text(), device_id_);
    bad_ = 0;
    measured_ = {messages_, now, HaplyVector::of(state.position), HaplyVector::of(state.velocity),
                 false};
    states.store(measured_);
  } catch (const HaplyProtocolError&) {
    malformed.fetch_add(1, std::memory_order_relaxed);
    if (++bad_ == HaplyDevice::kMostMalformed) {
      measured_.fault = true;
      states.store(measured_);
    }
  }
  buffer_.clear();
  unanswered_ = std::max(unanswered_ - 1, 0);
  // Else a zero that was sent unasked would leave one more message under way for good.
  if (unanswered_ == 0) answer();
}

void HaplyLink::answer() {
  if (closing_) return;
  const Nanoseconds next = sent_ + HaplyDevice::kShortestPeriod;
  if (monotonic_time() >= next) return send(Due::kAnswer);
  pace_.expires_at(instant(next));
  pace_.async_wait([this](const error_code& error) {
    if (!error && !closing_ && unanswered_ == 0) send(Due::kAnswer);
  });
}

void HaplyLink::send(Due due) {
  if (writing_) {
    due_ = std::max(due_, due);
  } else {
    write_force(due == Due::kAnswer ? current_force() : Vec3::Zero());
  }
}

Vec3 HaplyLink::current_force() {
  if (const auto sample = forces.load()) command_ = sample->value;
  const Nanoseconds age = monotonic_time() - command_.written;
  const bool fresh = age <= HaplyDevice::kForceLife && age >= -HaplyDevice::kForceLife;
  return fresh && !measured_.fault ? command_.force.value() : Vec3::Zero();
}

void HaplyLink::write_force(const Vec3& force) {
  out_ = haply_force_command(device_id_, force);
  sent_ = monotonic_time();
  ++unanswered_;
  writing_ = true;
  socket_.async_write(asio::buffer(out_), [this](const error_code& error, std::size_t) {
    if (error) return fail();
    writing_ = false;
    const Due due = std::exchange(due_, Due::kNothing);
    if (due != Due::kNothing) return send(due);
    if (closing_) socket_.async_close(websocket::close_code::normal, [this](auto) { fail(); });
  });
  watch(force.isZero(0));
}

// Until the next message: takes a force away that grows old, asks again a service that lost one.
void HaplyLink::watch(bool zero) {
  watched_ = zero ? sent_ + HaplyDevice::kAskAgain : command_.written + HaplyDevice::kForceLife;
  watch_.expires_at(instant(watched_));
  watch_.async_wait([this, zero](const error_code& error) {
    if (error || closing_ || monotonic_time() < watched_) return;
    if (zero) unanswered_ = 0;
    send(Due::kZero);
  });
}

void HaplyLink::close() {
  closing_ = true;
  pace_.cancel();
  watch_.cancel();
  limit_.expires_after(HaplyDevice::kCloseLimit);
  limit_.async_wait([this](const error_code& error) {
    if (!error) fail();
  });
  send(Due::kZero);
}

void HaplyLink::fail() noexcept {
  failed.store(true, std::memory_order_relaxed);
  measured_.fault = true;
  states.store(measured_);
  error_code ignored;
  socket_.next_layer().close(ignored);
  io_.stop();
}

}  // namespace gliss
