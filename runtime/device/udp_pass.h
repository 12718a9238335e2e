// Who may move the motor behind a UDP port: a random pass in a file that its owner alone can read,
// /run/user/UID/gliss-udp-PORT, or /tmp/gliss-UID/udp-PORT where there is no such folder, or
// ~/.gliss/udp-PORT where somebody else has that one. Who serves the device writes it; each force
// brings it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "gliss/base/export.h"
#include "gliss/device/udp_protocol.h"

namespace gliss::udp {

// The pass of a port that this process serves, for as long as it lives.
class GLISS_EXPORT OwnPass {
 public:
  // Throws LoopError, with file and cure, where the file cannot be written for this user alone.
  explicit OwnPass(std::uint16_t port);
  ~OwnPass();  // removes the file
  OwnPass(const OwnPass&) = delete;
  OwnPass& operator=(const OwnPass&) = delete;

  const Pass& value() const noexcept { return pass_; }
  // Writes the file again, elsewhere if need be, where it is gone: a session's folder goes with the
  // session. Where that fails, nothing happens.
  void keep() noexcept;

 private:
  void put_down();

  std::uint16_t port_;
  std::string path_;
  int descriptor_ = -1;  // locked while it is served
  Pass pass_{};
};

struct FoundPass {
  Pass pass{};
  bool served = false;  // its process lives
};

// The files that may hold the pass of a port, separated by commas.
GLISS_EXPORT std::string pass_paths(std::uint16_t port);

// The pass of a port that a process of this user serves, wherever it lies, or served; none where
// there is no file.
// Throws LoopError for a file that others could have written.
GLISS_EXPORT std::optional<FoundPass> find_pass(std::uint16_t port);

}  // namespace gliss::udp
