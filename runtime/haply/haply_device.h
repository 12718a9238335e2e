// An Inverse3 of Haply, through the Haply Inverse service.
//
// A thread of its own (HaplyOptions::priority) talks with the service; the loop's thread only reads
// and writes two seqlocks. Each state is answered by the latest force. No
// force stands for longer than kForceLife after the loop wrote it: then zero goes out, whether or
// not the service said anything meanwhile. Where the whole program dies, the connection ends, and
// the service lets the device go idle; how soon, its documentation does not say.
//
// The service is not trusted: a message that is no state is counted in malformed() and answered,
// kMostMalformed of them in a row are a fault until the next good one; a connection that ends, or a
// message over kLargestMessage or against the rules of WebSockets, is a fault for good. A service
// that is silent is no fault: the state grows old. Nothing is reconnected. The link is neither
// authenticated nor encrypted, and so stays within this machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/device/device.h"

namespace gliss {

struct HaplyOptions {
  std::string host = "localhost";  // this machine, by any of its loopback names
  std::uint16_t port = 10001;
  std::string device_id = {};  // empty: the first that is listed
  // SCHED_FIFO of the thread that talks with the service, 1 to 99: above the loop's, for that
  // thread takes the force away where the loop gets stuck. 0: scheduled as the caller.
  int priority = 0;
  Nanoseconds connect_timeout = std::chrono::seconds(2);  // until the first state has come
  // No figures of the Inverse3 were found in Haply's documentation: the largest force is the
  // guard's, the others are not known.
  double max_force = 3.3;                                          // N; no larger one goes out
  double max_stiffness = std::numeric_limits<double>::infinity();  // N/m
  Eigen::AlignedBox3d workspace = {};                              // m
};

class HaplyLink;

class GLISS_EXPORT HaplyDevice final : public HapticDevice {
 public:
  // The rest of the 20 ms that a stuck loop may leave its force is for waking and the service.
  static constexpr Nanoseconds kForceLife = std::chrono::milliseconds(15);
  // A service that answers at once would keep a core busy; also the shortest time between forces.
  static constexpr Nanoseconds kShortestPeriod = std::chrono::microseconds(250);
  static constexpr Nanoseconds kAskAgain = std::chrono::milliseconds(100);  // for a lost state
  static constexpr int kMostMalformed = 10;
  static constexpr std::size_t kLargestMessage = 64 << 10;
  static constexpr Nanoseconds kCloseLimit = std::chrono::milliseconds(250);

  // Returns with the first state. Throws std::invalid_argument for options that make no sense;
  // LoopError, one line with host, port, reason and cure. Finding the host's address may take
  // longer than the timeout where a name server does.
  explicit HaplyDevice(const HaplyOptions& options = {});
  // Sends a zero force and closes, within kCloseLimit.
  ~HaplyDevice() override;
  HaplyDevice(const HaplyDevice&) = delete;
  HaplyDevice& operator=(const HaplyDevice&) = delete;

  const DeviceInfo& info() const noexcept override { return info_; }  // name "haply:049D"
  // Measured: when the message arrived.
  DeviceState read(Nanoseconds now) noexcept override;
  // On CLOCK_MONOTONIC. A force that is not finite is sent as zero, and false.
  bool write(const Vec3& force, Nanoseconds now) noexcept override;

  std::vector<std::string> refusals() const override;  // of real-time scheduling
  std::uint64_t malformed() const noexcept;            // messages so far

 private:
  DeviceInfo info_;
  DeviceState last_;
  std::unique_ptr<HaplyLink> link_;
};

// The words that open_haply() knows; the port is that of HaplyOptions unless it is named.
inline constexpr char kHaplyWords[] = "haply, haply:HOST or haply:HOST:PORT";

// Opens the device that these words name, with HaplyOptions::priority; null where they name none.
// Throws as HaplyDevice does.
GLISS_EXPORT std::unique_ptr<HapticDevice> open_haply(const std::string& words, int priority);

}  // namespace gliss
