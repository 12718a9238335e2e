// HaplyDevice's side in its I/O thread: the connection, and the rules by which forces go out. For
// haply_device.cpp and haply_link.cpp only.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <string>
#include <string_view>
#include <thread>

#include "gliss/haply/haply_device.h"
#include "gliss/thread/seqlock.h"

namespace gliss {

// In plain words: Eigen's vectors are not trivially copyable.
struct HaplyVector {
  double x, y, z;

  static HaplyVector of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
  Vec3 value() const { return {x, y, z}; }
};

struct HaplyMeasured {
  std::uint64_t sequence;
  Nanoseconds time;
  HaplyVector position, velocity;
  bool fault;
};

struct HaplyForce {
  HaplyVector force;
  Nanoseconds written;
};

class HaplyLink {
 public:
  explicit HaplyLink(const HaplyOptions& options);
  ~HaplyLink();

  // Any thread; states and failed are written by the I/O thread, forces by the loop's.
  const std::string& device_id() const { return device_id_; }
  const std::string& refused() const { return refused_; }  // of real-time scheduling; "": nothing
  Seqlock<HaplyMeasured> states;
  Seqlock<HaplyForce> forces;
  std::atomic<bool> failed{false};
  std::atomic<std::uint64_t> malformed{0};

 private:  // the I/O thread's, the constructor's before it runs
  enum class Due { kNothing, kAnswer, kZero };

  template <class Start>
  boost::system::error_code wait_for(const std::string& what, const Start& start);
  void open(const HaplyOptions& options);
  void run() noexcept;
  void listen();
  void take_message();
  void answer();
  void send(Due due);
  void write_force(const Vec3& force);
  void watch(bool zero);
  Vec3 current_force();
  void close();
  void fail() noexcept;
  std::string_view text() const {
    return {static_cast<const char*>(buffer_.cdata().data()), buffer_.size()};
  }

  const std::string where_;  // "haply: localhost:10001"
  std::string device_id_;
  const std::chrono::steady_clock::time_point deadline_;  // of the constructor
  boost::asio::io_context io_{1};
  boost::beast::websocket::stream<boost::asio::ip::tcp::socket, false> socket_{io_};
  boost::asio::steady_timer pace_{io_}, watch_{io_}, limit_{io_};
  boost::beast::flat_buffer buffer_{HaplyDevice::kLargestMessage};
  std::string out_;  // while it is being written
  bool writing_ = false, closing_ = false;
  Due due_ = Due::kNothing;  // after what is being written
  int unanswered_ = 0;       // messages sent that no state came for
  int bad_ = 0;              // malformed messages in a row
  std::uint64_t messages_ = 0;
  Nanoseconds sent_{}, watched_{};  // last message; when its watch ends
  HaplyMeasured measured_{};
  HaplyForce command_{};
  std::thread thread_;
  std::string refused_;
};

}  // namespace gliss
