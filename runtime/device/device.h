// A haptic device as a loop needs it. Positions in m, velocities in m/s, forces in N and torques
// in N m on the hand, all in the world's frame.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/base/vector.h"
#include "gliss/base/wrench.h"
#include "gliss/thread/clock.h"

namespace gliss {

struct DeviceInfo {
  std::string name;                                                // "udp:10002"
  double max_force = std::numeric_limits<double>::infinity();      // N
  double max_stiffness = std::numeric_limits<double>::infinity();  // N/m
  double max_torque = std::numeric_limits<double>::infinity();     // N m
  Eigen::AlignedBox3d workspace;                                   // m; empty: not known
  bool has_velocity = false;                                       // else velocities are zero
  bool has_orientation = false;  // else it does not turn, and torques go nowhere
  bool real_time = true;         // false: it lives in the loop's time, however fast that runs
};

// The latest that the device has measured.
struct DeviceState {
  std::uint64_t sequence = 0;  // grows with each measurement, by more than 1 where some were lost;
                               // 0: there is none yet, and nothing else here counts
  Nanoseconds measured{};      // on the loop's clock; no later than the loop first saw it
  Vec3 position = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  Rotation orientation = Rotation::Identity();  // of the tool, unit
  bool fault = false;  // the device says that it failed; the force is to end
  bool ended = false;  // nothing comes after this
};

// One thread's, the loop's, which calls read() and then write() in each tick and passes its clock
// (`now`, never backwards). Neither waits, locks or allocates. A device that is destroyed leaves
// no force on the hand; one whose program was killed takes it away within 20 ms.
class GLISS_EXPORT HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual const DeviceInfo& info() const noexcept = 0;
  virtual DeviceState read(Nanoseconds now) noexcept = 0;
  // False where the force cannot be handed on; it then counts as a fault.
  virtual bool write(const Vec3& force, Nanoseconds now) noexcept = 0;
  // ... with a torque about the device's position. A device without orientation has no use for it.
  virtual bool write_wrench(const Wrench& wrench, Nanoseconds now) noexcept {
    return write(wrench.force, now);
  }
  // Lines about what the system refused to threads of the device's own; not called in the loop.
  virtual std::vector<std::string> refusals() const { return {}; }
  // Tells a person how the device failed; not called in the loop.
  virtual std::string fault_text() const { return "the device reports a fault"; }
};

}  // namespace gliss
