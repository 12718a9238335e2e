// A Haply Inverse service without a device, in a thread: sends an inventory, then a message for
// each that it gets. What it sends is up to the test, what it got is kept with its time.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gliss/mesh/mesh.h"
#include "gliss/thread/clock.h"

namespace gliss::test {

struct HaplyReply {
  enum Act { kSend, kStaySilent, kClose, kDrop };  // kDrop: without a closing handshake
  std::string text;
  Act act = kSend;
  int frames = 1;  // that the message is sent in
};

struct HaplyCommand {  // that the mock got
  Nanoseconds time;
  std::string device_id;
  Vec3 force;  // NaN where the message has not exactly the documented form
};

// {"inverse3": [...]} with one inverse3, and with what the service tells besides.
std::string haply_message(const std::string& device_id, const Vec3& position, const Vec3& velocity);

class HaplyMock {
 public:
  enum class Kind { kService, kHttp, kMute };  // kMute: accepts connections and says nothing

  // `reply` is called in the mock's thread with 0, for the inventory, then 1, 2, ...
  using Reply = std::function<HaplyReply(std::uint64_t number)>;
  explicit HaplyMock(Reply reply, Kind kind = Kind::kService);
  ~HaplyMock();

  std::uint16_t port() const;
  std::vector<HaplyCommand> commands() const;
  bool closed_cleanly() const;  // the client said goodbye

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace gliss::test
