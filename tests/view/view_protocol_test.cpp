// All that a browser may send to gliss view: what is not exactly right is refused.
#include "tools/view/view_protocol.h"

#include <gmock/gmock.h>

#include <cmath>

namespace gliss::tools {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";
const ViewDoor kDoor{8080, kToken};

ViewAnswer answer(const std::string& head) { return judge_request(head, kDoor).answer; }

std::string page_request(const std::string& host, const std::string& more = "",
                         const std::string& first = "GET / HTTP/1.1") {
  return first + "\r\nHost: " + host + "\r\n" + more + "\r\n";
}

struct Upgrade {
  std::string host = "127.0.0.1:8080", origin = "Origin: http://127.0.0.1:8080\r\n",
              protocol = "Sec-WebSocket-Protocol: gliss." + kToken + "\r\n", target = "/touch",
              more = "";

  std::string text() const {
    return "GET " + target + " HTTP/1.1\r\nHost: " + host +
           "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
           origin + protocol + more + "\r\n";
  }
};

TEST(ViewProtocol, gives_its_page_to_a_browser_of_this_machine) {
  EXPECT_EQ(answer(page_request("127.0.0.1:8080")), ViewAnswer::kPage);
  EXPECT_EQ(answer(page_request("localhost:8080")), ViewAnswer::kPage);
  EXPECT_EQ(answer(page_request("localhost:8080", "Origin: http://localhost:8080\r\n")),
            ViewAnswer::kPage);
  EXPECT_TRUE(
      judge_request(page_request("localhost:8080", "", "HEAD / HTTP/1.1"), kDoor).head_only);
}

TEST(ViewProtocol, refuses_every_other_host) {
  for (const char* host :
       {"127.0.0.1", "localhost", "127.0.0.1:80", "127.0.0.1:80800", "evil.example:8080",
        "localhost:8080.evil.example", "localhost.:8080", "LOCALHOST:8080", "[::1]:8080",
        "127.0.0.1:8080, evil.example", "127.1:8080", "user@127.0.0.1:8080", ""})
    EXPECT_EQ(answer(page_request(host)), ViewAnswer::kForbidden) << host;
  EXPECT_EQ(answer("GET / HTTP/1.1\r\n\r\n"), ViewAnswer::kForbidden);
  EXPECT_EQ(answer(page_request("localhost:8080", "Host: localhost:8080\r\n")),
            ViewAnswer::kForbidden)
      << "twice";
  EXPECT_EQ(answer(page_request("localhost:8080", "Origin: http://evil.example\r\n")),
            ViewAnswer::kForbidden);
}

TEST(ViewProtocol, has_one_page_and_one_socket) {
  const std::string host = "localhost:8080";
  for (const char* path :
       {"/favicon.ico", "/touch/", "//", "/?a", "/../etc/passwd", "/%2e", "http://localhost:8080/"})
    EXPECT_EQ(answer(page_request(host, "", std::string("GET ") + path + " HTTP/1.1")),
              ViewAnswer::kNotFound)
        << path;
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT"})
    EXPECT_EQ(answer(page_request(host, "", std::string(method) + " / HTTP/1.1")),
              ViewAnswer::kNotAllowed)
        << method;
  EXPECT_EQ(answer(page_request(host, "", "GET /touch HTTP/1.1")), ViewAnswer::kBadRequest)
      << "no upgrade";
}

TEST(ViewProtocol, refuses_what_is_no_request) {
  const std::string host = "localhost:8080";
  for (const std::string& head :
       {std::string(), std::string("\r\n\r\n"), std::string("GET / HTTP/1.1\r\nHost: x"),
        page_request(host, "", "GET / HTTP/1.0"), page_request(host, "", "GET /"),
        page_request(host, "Content-Length: 3\r\n"),
        page_request(host, "Transfer-Encoding: chunked\r\n"), page_request(host, "no colon\r\n"),
        page_request(host, std::string("X: \0\r\n", 6)), page_request(host) + page_request(host),
        page_request(host, "X: " + std::string(kLongestHead, 'x') + "\r\n")})
    EXPECT_EQ(answer(head), ViewAnswer::kBadRequest) << head.substr(0, 80);
}

TEST(ViewProtocol, lets_in_who_has_the_token_and_the_origin) {
  EXPECT_EQ(answer(Upgrade{}.text()), ViewAnswer::kSocket);
  Upgrade by_name;
  by_name.host = "localhost:8080";
  by_name.origin = "Origin: http://localhost:8080\r\n";
  EXPECT_EQ(answer(by_name.text()), ViewAnswer::kSocket);

  for (const char* origin :
       {"", "Origin: null\r\n", "Origin: http://localhost:8080\r\n", "Origin: http://127.0.0.1\r\n",
        "Origin: https://127.0.0.1:8080\r\n", "Origin: http://127.0.0.1:8080/\r\n",
        "Origin: http://evil.example\r\n",
        "Origin: http://127.0.0.1:8080\r\nOrigin: http://127.0.0.1:8080\r\n"}) {
    Upgrade wrong;
    wrong.origin = origin;
    EXPECT_EQ(answer(wrong.text()), ViewAnswer::kForbidden) << origin;
  }
  for (const std::string& protocol :
       {std::string(), std::string("gliss."), "gliss." + kToken.substr(1), "gliss." + kToken + "0",
        "gliss.1" + kToken.substr(1), kToken, "gliss." + kToken + ", chat", "chat, gliss." + kToken,
        "GLISS." + kToken}) {
    Upgrade wrong;
    wrong.protocol = protocol.empty() ? "" : "Sec-WebSocket-Protocol: " + protocol + "\r\n";
    EXPECT_EQ(answer(wrong.text()), ViewAnswer::kForbidden) << protocol;
  }
  Upgrade twice;
  twice.more = twice.protocol;
  EXPECT_EQ(answer(twice.text()), ViewAnswer::kForbidden);
  Upgrade elsewhere;
  elsewhere.target = "/";
  EXPECT_EQ(answer(elsewhere.text()), ViewAnswer::kPage) << "no socket there";
}

TEST(ViewProtocol, makes_tokens_that_nobody_guesses) {
  const std::string one = make_view_token(), other = make_view_token();
  EXPECT_TRUE(is_view_token(one)) << one;
  EXPECT_NE(one, other);
  for (const char* wrong :
       {"", "0123", "0123456789ABCDEF0123456789ABCDEF", "0123456789abcdef0123456789abcdef0",
        "0123456789abcdef0123456789abcdeg"})
    EXPECT_FALSE(is_view_token(wrong)) << wrong;
}

// A message that tunes, good but for what is put in.
std::string tune(const std::string& method = "\"flat\"", const std::string& stiffness = "800",
                 const std::string& friction = "[0.5,0.3]", const std::string& settle = "0.005",
                 const std::string& texture = R"({"kind":"none","height":0,"period":0})") {
  return fmt::format(
      R"({{"tune":{{"method":{},"stiffness":{},"friction":{},"settle":{},"texture":{}}}}})", method,
      stiffness, friction, settle, texture);
}

std::string textured(const std::string& kind, const std::string& height) {
  return tune("\"flat\"", "800", "[0,0]", "0",
              fmt::format(R"({{"kind":"{}","height":{},"period":0.002}})", kind, height));
}

TEST(ViewProtocol, reads_the_messages_of_the_page) {
  const auto hand = read_view_message(R"({"hand":[0.001,-2e-3,3]})");
  ASSERT_TRUE(hand);
  EXPECT_EQ(std::get<HandMessage>(*hand).target, Vec3(0.001, -2e-3, 3));
  const auto tuned = read_view_message(tune());
  ASSERT_TRUE(tuned);
  const auto& wanted = std::get<TuneMessage>(*tuned);
  EXPECT_EQ(wanted.method, Method::kFlat);
  EXPECT_EQ(wanted.stiffness, 800);
  EXPECT_EQ(wanted.friction.at_rest, 0.5);
  EXPECT_EQ(wanted.friction.slipping, 0.3);
  EXPECT_EQ(wanted.settle, 0.005);
  EXPECT_FALSE(wanted.texture.any());
  const auto rough = std::get<TuneMessage>(*read_view_message(textured("noise", "5e-5"))).texture;
  EXPECT_EQ(rough.relief, Relief::kNoise);
  EXPECT_EQ(rough.height, 5e-5);
  EXPECT_EQ(rough.period, 2e-3);
  const auto build = std::get<BuildMessage>(
      *read_view_message(R"({"build":{"level":"table:8","construction":"paper","crease":40}})"));
  EXPECT_EQ(build.level.kind, Level::kTable);
  EXPECT_EQ(build.level.cells, 8u);
  EXPECT_EQ(build.level.construction, Construction::kPaper);
  EXPECT_EQ(build.crease, 40);
  EXPECT_FALSE(
      std::get<BuildMessage>(
          *read_view_message(R"({"build":{"level":"exact","construction":"fair","crease":null}})"))
          .crease);
  EXPECT_TRUE(std::get<ReplayMessage>(*read_view_message(R"({"replay":true})")).on);
  EXPECT_TRUE(std::holds_alternative<SaveMessage>(*read_view_message(R"({"save":true})")));
  EXPECT_TRUE(std::get<RecordMessage>(*read_view_message(R"({"record":true})")).on);
  EXPECT_FALSE(std::get<RecordMessage>(*read_view_message(R"({"record":false})")).on);
  EXPECT_TRUE(std::holds_alternative<EngageMessage>(*read_view_message(R"({"engage":true})")));
}

TEST(ViewProtocol, reads_nothing_else) {
  const std::string deep = std::string(2000, '[') + std::string(2000, ']');
  for (const std::string& text :
       {std::string(),
        std::string("{}"),
        std::string("[]"),
        std::string("null"),
        std::string("7"),
        std::string("hand"),
        std::string(R"({"hand":[1,2]})"),
        std::string(R"({"hand":[1,2,3,4]})"),
        std::string(R"({"hand":[1,2,"3"]})"),
        std::string(R"({"hand":[1,2,null]})"),
        std::string(R"({"hand":[1,2,1e999]})"),
        std::string(R"({"hand":[1,2,1e7]})"),
        std::string(R"({"hand":[1,2,NaN]})"),
        std::string(R"({"hand":{"x":1}})"),
        std::string(R"({"hand":[1,2,3],"record":true})"),
        std::string(R"({"hand":[1,2,3]} x)"),
        std::string(R"({"record":1})"),
        std::string(R"({"record":"/etc/passwd"})"),
        std::string(R"({"engage":false})"),
        std::string(R"({"open":"/etc/passwd"})"),
        tune("\"best\""),
        tune("\"flat\"", "0"),
        tune("\"flat\"", "1e99"),
        tune("\"flat\"", "8", "[0.3,0.5]"),
        tune("\"flat\"", "8", "[9,0]"),
        tune("\"flat\"", "8", "[0,0]", "2"),
        tune("\"flat\"", "8", "[0,0]", "0", "null"),
        tune("\"flat\"", "8", "[0,0]", "0,\"level\":1"),
        textured("grating", "1"),
        textured("grating", "-1"),
        textured("holes", "1e-5"),
        std::string(R"({"build":{"level":"best","construction":"fair","crease":null}})"),
        std::string(R"({"build":{"level":"exact","construction":"fair"}})"),
        std::string(R"({"build":{"level":"exact","construction":"fair","crease":181}})"),
        std::string(R"({"build":{"level":"exact","construction":"fair","crease":"edges:/x"}})"),
        std::string(R"({"replay":"/etc/passwd"})"),
        std::string(R"({"save":"/etc/passwd"})"),
        std::string("\xff\xfe{\"record\":true}"),
        std::string("{\"record\":true\0}", 16),
        deep,
        R"({"hand":[1,2,3])" + std::string(kLongestMessage, ' ') + "}"})
    EXPECT_FALSE(read_view_message(text)) << text.substr(0, 80);
}

TEST(ViewProtocol, allows_two_hundred_messages_a_second) {
  MessageAllowance allowance;
  for (int i = 0; i < 100'000; ++i) ASSERT_TRUE(allowance.take(5 + i / 199.0)) << i;
  MessageAllowance at_once;
  int allowed = 0;
  for (int i = 0; i < 1000; ++i) allowed += at_once.take(7);
  EXPECT_EQ(allowed, 200);
  EXPECT_FALSE(at_once.take(6)) << "a clock that goes back gives nothing";
}

}  // namespace
}  // namespace gliss::tools
