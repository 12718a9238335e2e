// The server of gliss view before pages that are slow, silent, hostile or not pages at all.
#include "tools/view/view_server.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <thread>

#include "gliss/thread/realtime.h"
#include "tests/view/browser_side.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

constexpr char kPage[] =
    "<html><meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
    "'sha256-x'\"><p>page</p></html>";

SharedPayload text_of(const std::string& text) {
  return std::make_shared<const ViewPayload>(ViewPayload{true, text});
}

class ViewServerTest : public testing::Test {
 protected:
  ViewServerTest() {
    thread_ = std::thread([this] {
      while (!stop_) {
        server_.run_for(5ms);
        if (flood_)
          server_.send_frame(
              std::make_shared<const ViewPayload>(ViewPayload{false, std::string(1 << 20, 'x')}));
        pages_ = server_.watching();
        ++turns_;
      }
    });
  }
  ~ViewServerTest() override { stop(); }

  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::uint16_t port() const { return server_.port(); }
  // All that the server answers to these bytes until it closes.
  std::string answer(const std::string& bytes) const {
    asio::io_context io;
    tcp::socket socket(io);
    socket.connect({asio::ip::address_v4::loopback(), port()});
    error_code error;
    asio::write(socket, asio::buffer(bytes), error);
    std::string text;
    asio::read(socket, asio::dynamic_buffer(text), error);
    return text;
  }
  std::string get(const std::string& host, const std::string& path = "/") const {
    return answer(fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", path, host));
  }
  std::string host() const { return fmt::format("localhost:{}", port()); }
  void wait_for_pages(std::size_t count) const {
    for (int i = 0; i < 1000 && pages_ != count; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(pages_, count);
  }

  const std::string token_ = make_view_token();
  std::atomic<int> hands_ = 0, others_ = 0;
  std::atomic<bool> flood_ = false;
  std::atomic<std::size_t> pages_ = 0;
  std::atomic<int> turns_ = 0;
  ViewServer server_{
      0,
      kPage,
      token_,
      {[](bool steers) { return std::vector{text_of(steers ? "steers" : "watches")}; },
       [this](const ViewMessage& message) {
         ++(std::holds_alternative<HandMessage>(message) ? hands_ : others_);
       },
       [] { return text_of("steers now"); }}};

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

TEST_F(ViewServerTest, serves_its_page_with_all_that_keeps_it_apart) {
  const std::string page = get(host());
  EXPECT_THAT(page, testing::StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(page, testing::EndsWith(kPage));
  for (const char* line :
       {"Content-Security-Policy: default-src 'none'; script-src 'sha256-x'; frame-ancestors "
        "'none'; base-uri 'none'; form-action 'none'\r\n",
        "X-Frame-Options: DENY\r\n", "X-Content-Type-Options: nosniff\r\n",
        "Referrer-Policy: no-referrer\r\n", "Cross-Origin-Resource-Policy: same-origin\r\n",
        "Cache-Control: no-store\r\n"})
    EXPECT_THAT(page, testing::HasSubstr(line));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("Access-Control")));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr(token_)));
  EXPECT_THAT(answer("HEAD / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n"),
              testing::EndsWith("\r\n\r\n"));
}

TEST_F(ViewServerTest, listens_on_this_machine_alone) {
  EXPECT_EQ(server_.url(), fmt::format("http://127.0.0.1:{}/#{}", port(), token_));
  asio::io_context io;
  tcp::socket socket(io);
  error_code error;
  // Another address of this very machine.
  socket.connect({asio::ip::make_address_v4("127.0.0.2"), port()}, error);
  EXPECT_TRUE(error);
  EXPECT_THROW(ViewServer(port(), kPage, token_, {}), LoopError) << "the port is taken";
}

TEST_F(ViewServerTest, refuses_what_other_pages_can_make_a_browser_send) {
  EXPECT_THAT(get("evil.example"), testing::StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get("127.0.0.1:1"), testing::StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get(host(), "/secret"), testing::StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(answer("POST / HTTP/1.1\r\nHost: " + host() + "\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(answer("\x16\x03\x01\r\n\r\n"), testing::StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer("GET / HTTP/1.1\r\nX: " + std::string(kLongestHead, 'x')),
              testing::StartsWith("HTTP/1.1 400"));
  EXPECT_EQ(BrowserSide(port()).open(token_, "http://evil.example"),
            websocket::error::upgrade_declined);
  EXPECT_EQ(BrowserSide(port()).open(token_, "null"), websocket::error::upgrade_declined);
  EXPECT_EQ(BrowserSide(port()).open(make_view_token()), websocket::error::upgrade_declined);
  EXPECT_EQ(BrowserSide(port()).open(""), websocket::error::upgrade_declined);
  EXPECT_EQ(pages_, 0u);
  BrowserSide good(port());
  EXPECT_FALSE(good.open(token_)) << "nothing of it did harm";
  EXPECT_EQ(good.receive(), "steers");
}

TEST_F(ViewServerTest, lets_one_page_steer_and_others_watch) {
  BrowserSide first(port()), second(port()), third(port());
  ASSERT_FALSE(first.open(token_));
  EXPECT_EQ(first.receive(), "steers");
  ASSERT_FALSE(second.open(token_));
  EXPECT_EQ(second.receive(), "watches");
  ASSERT_FALSE(third.open(token_));
  EXPECT_EQ(third.receive(), "watches");
  EXPECT_FALSE(second.send(R"({"hand":[0,0,0]})"));
  EXPECT_FALSE(second.send(R"({"record":true})"));
  EXPECT_FALSE(first.send(R"({"hand":[0,0,0]})"));
  for (int i = 0; i < 500 && hands_ == 0; ++i) std::this_thread::sleep_for(2ms);
  std::this_thread::sleep_for(50ms);
  EXPECT_EQ(hands_, 1);
  EXPECT_EQ(others_, 0);
  first.connection().close();
  EXPECT_EQ(second.receive(), "steers now");
  EXPECT_FALSE(second.send(R"({"record":true})"));
  for (int i = 0; i < 500 && others_ == 0; ++i) std::this_thread::sleep_for(2ms);
  EXPECT_EQ(others_, 1);
}

TEST_F(ViewServerTest, closes_pages_that_send_what_makes_no_sense) {
  struct Case {
    std::string bytes;
    bool is_text;
    websocket::close_code why;
  };
  for (const Case& sent :
       {Case{"hello", true, websocket::close_code::policy_error},
        Case{R"({"hand":[1,2]})", true, websocket::close_code::policy_error},
        Case{R"({"record":"/etc/passwd"})", true, websocket::close_code::policy_error},
        Case{R"({"hand":[0,0,0]})", false, websocket::close_code::policy_error},
        Case{std::string(28, '\0'), false, websocket::close_code::policy_error},
        Case{std::string(1 << 20, ' '), true, websocket::close_code::too_big},
        Case{"\xff\xff", true, websocket::close_code::bad_payload}}) {
    BrowserSide page(port());
    ASSERT_FALSE(page.open(token_));
    EXPECT_NE(page.receive(), "");
    page.send(sent.bytes, sent.is_text);
    EXPECT_EQ(page.receive(), "");
    // A page that still sends may see the end of the connection before the reason.
    if (page.closed == websocket::error::closed) {
      EXPECT_EQ(page.why(), sent.why) << sent.bytes[0];
    }
  }
  wait_for_pages(0);
  EXPECT_EQ(hands_ + others_, 0);
}

TEST_F(ViewServerTest, closes_pages_that_send_too_often) {
  BrowserSide page(port());
  ASSERT_FALSE(page.open(token_));
  page.receive();
  for (int i = 0; i < 1000 && !page.send(R"({"hand":[0,0,0]})"); ++i) {
  }
  EXPECT_EQ(page.receive(), "");
  wait_for_pages(0);
  EXPECT_LT(hands_, 400) << "200 at once, and 200 a second meanwhile";
}

TEST_F(ViewServerTest, loses_frames_of_a_page_that_reads_none_and_waits_for_nobody) {
  BrowserSide slow(port());
  ASSERT_FALSE(slow.open(token_));
  wait_for_pages(1);
  flood_ = true;
  const int before = turns_;
  std::this_thread::sleep_for(400ms);
  flood_ = false;
  EXPECT_GT(turns_ - before, 10) << "the server goes on";
  BrowserSide quick(port());
  EXPECT_FALSE(quick.open(token_));
  EXPECT_EQ(quick.receive(), "watches");
  stop();
  EXPECT_GT(server_.counts().frames_lost, 5u);
}

TEST_F(ViewServerTest, bears_any_number_of_connections) {
  asio::io_context io;
  std::vector<tcp::socket> idle;
  for (std::size_t i = 0; i < 3 * ViewServer::kMostConnections; ++i) {
    error_code error;
    idle.emplace_back(io).connect({asio::ip::address_v4::loopback(), port()}, error);
  }
  std::this_thread::sleep_for(50ms);
  idle.clear();
  std::string page;
  for (int i = 0; i < 100 && page.empty(); ++i) {
    std::this_thread::sleep_for(10ms);
    page = get(host());
  }
  EXPECT_THAT(page, testing::StartsWith("HTTP/1.1 200"));
}

TEST_F(ViewServerTest, ends_connections_that_never_ask) {
  asio::io_context io;
  tcp::socket silent(io);
  silent.connect({asio::ip::address_v4::loopback(), port()});
  asio::write(silent, asio::buffer(std::string("GET / HT")));
  char byte;
  error_code error;
  const auto began = std::chrono::steady_clock::now();
  silent.read_some(asio::buffer(&byte, 1), error);
  EXPECT_TRUE(error);
  EXPECT_LT(std::chrono::steady_clock::now() - began, ViewServer::kHandshake + 5s);
}

TEST(ViewPage, has_its_policy_in_its_head) {
  EXPECT_EQ(policy_of(kPage), "default-src 'none'; script-src 'sha256-x'");
  EXPECT_EQ(policy_of("<p>"), "default-src 'none'");
}

}  // namespace
}  // namespace gliss::tools
