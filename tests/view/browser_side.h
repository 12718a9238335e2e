// The browser's side of gliss view: one call after the other, and any bytes.
#pragma once

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <string>

namespace gliss::tools {

class BrowserSide {
 public:
  explicit BrowserSide(std::uint16_t port) : socket_(io_) {
    socket_.next_layer().connect({boost::asio::ip::address_v4::loopback(), port});
  }

  boost::system::error_code open(const std::string& token, const std::string& origin = "") {
    const std::string host =
        fmt::format("127.0.0.1:{}", socket_.next_layer().remote_endpoint().port());
    socket_.set_option(boost::beast::websocket::stream_base::decorator(
        [&](boost::beast::websocket::request_type& request) {
          request.set("Origin", origin.empty() ? "http://" + host : origin);
          request.set("Sec-WebSocket-Protocol", "gliss." + token);
        }));
    boost::system::error_code error;
    socket_.handshake(host, "/touch", error);
    return error;
  }
  boost::system::error_code send(const std::string& text, bool is_text = true) {
    boost::system::error_code error;
    socket_.text(is_text);
    socket_.write(boost::asio::buffer(text), error);
    return error;
  }
  // "" where the server has closed; the reason is then in `closed`.
  std::string receive() {
    boost::beast::flat_buffer buffer;
    boost::system::error_code error;
    socket_.read(buffer, error);
    closed = error;
    return error ? "" : std::string(static_cast<const char*>(buffer.data().data()), buffer.size());
  }
  boost::beast::websocket::close_code why() const {
    return static_cast<boost::beast::websocket::close_code>(socket_.reason().code);
  }
  boost::asio::ip::tcp::socket& connection() { return socket_.next_layer(); }

  boost::system::error_code closed;

 private:
  boost::asio::io_context io_;
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_;
};

}  // namespace gliss::tools
