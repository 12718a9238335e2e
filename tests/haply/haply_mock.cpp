#include "tests/haply/haply_mock.h"

#include <sys/socket.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/numbers.h"

namespace gliss::test {
namespace {

namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using Json = nlohmann::json;
using Socket = websocket::stream<tcp::socket, false>;

Json json_of(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

HaplyCommand parsed(Nanoseconds time, const std::string& text) {
  const Json message = Json::parse(text, nullptr, false);
  try {
    const Json& device = message.at("inverse3").at(0);
    const Json& force = device.at("commands").at("set_cursor_force").at("vector");
    const Vec3 vector(force.at("x"), force.at("y"), force.at("z"));
    const std::string id = device.at("device_id");
    const Json form{{"device_id", id},
                    {"commands", {{"set_cursor_force", {{"vector", json_of(vector)}}}}}};
    if (message == Json{{"inverse3", Json::array({form})}}) return {time, id, vector};
  } catch (const Json::exception&) {
  }
  return {time, text, Vec3::Constant(kNaN)};
}

}  // namespace

std::string haply_message(const std::string& device_id, const Vec3& position,
                          const Vec3& velocity) {
  const Json device{{"device_id", device_id},
                    {"config", {{"type", "inverse3"}, {"handedness", "right"}}},
                    {"state",
                     {{"cursor_position", json_of(position)},
                      {"cursor_velocity", json_of(velocity)},
                      {"angular_position", {{"a0", -69.3}, {"a1", 137.6}, {"a2", 19.8}}},
                      {"control_mode", "idle"}}},
                    {"status", {{"ready", true}}}};
  return Json{{"session_id", 7}, {"inverse3", Json::array({device})}}.dump();
}

class HaplyMock::Server {
 public:
  Server(Reply reply, Kind kind) : reply_(std::move(reply)), kind_(kind) {
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() {
    stop_ = true;
    ::shutdown(acceptor_.native_handle(), SHUT_RDWR);  // ends what the thread waits for
    {
      const std::lock_guard lock(mutex_);
      if (client_ >= 0) ::shutdown(client_, SHUT_RDWR);
    }
    thread_.join();
  }

  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  std::vector<HaplyCommand> commands() const {
    const std::lock_guard lock(mutex_);
    return commands_;
  }
  bool closed_cleanly() const { return closed_cleanly_; }

 private:
  void serve() {
    while (!stop_) {
      boost::system::error_code error;
      Socket socket(io_);
      acceptor_.accept(socket.next_layer(), error);
      if (error) return;
      client_is(socket.next_layer().native_handle());
      try {
        talk(socket);
      } catch (const boost::system::system_error& failure) {
        if (failure.code() == websocket::error::closed) closed_cleanly_ = true;
      }
      client_is(-1);
    }
  }

  void client_is(int client) {
    const std::lock_guard lock(mutex_);
    client_ = client;
  }

  void talk(Socket& socket) {
    if (kind_ == Kind::kHttp) {
      const std::string answer = "HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n";
      asio::write(socket.next_layer(), asio::buffer(answer));
    }
    boost::beast::flat_buffer buffer;
    if (kind_ != Kind::kService) {
      for (char byte;;) socket.next_layer().receive(asio::buffer(&byte, 1));
    }
    socket.next_layer().set_option(tcp::no_delay(true));
    socket.accept();
    socket.text(true);
    for (std::uint64_t number = 0;; ++number) {
      if (!send(socket, reply_(number))) return;
      buffer.clear();
      socket.read(buffer);
      HaplyCommand command =
          parsed(monotonic_time(), boost::beast::buffers_to_string(buffer.data()));
      const std::lock_guard lock(mutex_);
      commands_.push_back(std::move(command));
    }
  }

  // False where it was the last.
  static bool send(Socket& socket, const HaplyReply& reply) {
    if (reply.act == HaplyReply::kDrop) return false;
    if (reply.act == HaplyReply::kClose) return socket.close(websocket::close_code::normal), false;
    if (reply.act == HaplyReply::kStaySilent) return true;
    const auto frames = static_cast<std::size_t>(reply.frames);
    const std::size_t size = reply.text.size();
    for (std::size_t i = 0; i < frames; ++i) {
      const std::size_t begin = size * i / frames, end = size * (i + 1) / frames;
      socket.write_some(i + 1 == frames, asio::buffer(reply.text.data() + begin, end - begin));
    }
    return true;
  }

  const Reply reply_;
  const Kind kind_;
  asio::io_context io_;
  tcp::acceptor acceptor_{io_, {asio::ip::make_address("127.0.0.1"), 0}};
  std::atomic<bool> stop_{false}, closed_cleanly_{false};
  mutable std::mutex mutex_;
  std::vector<HaplyCommand> commands_;
  int client_ = -1;
  std::thread thread_;
};

HaplyMock::HaplyMock(Reply reply, Kind kind)
    : server_(std::make_unique<Server>(std::move(reply), kind)) {}
HaplyMock::~HaplyMock() = default;
std::uint16_t HaplyMock::port() const { return server_->port(); }
std::vector<HaplyCommand> HaplyMock::commands() const { return server_->commands(); }
bool HaplyMock::closed_cleanly() const { return server_->closed_cleanly(); }

}  // namespace gliss::test
