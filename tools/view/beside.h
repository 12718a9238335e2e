// The three methods beside one another on the HIPs of a loop, and how they go to the page.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gliss/contact/tracker.h"
#include "gliss/loop/loop.h"
#include "tools/view/view_protocol.h"

namespace gliss::tools {

// The order in which all of gliss view has them.
inline constexpr std::array<Method, 3> kViewMethods = {Method::kFlat, Method::kShaded,
                                                       Method::kGregory};

// A method in one tick, in the world's frame.
struct FeltBeside {
  Vec3 force = Vec3::Zero();  // N, as rendered
  Vec3 scp = Vec3::Zero();    // m; the HIP where nothing is touched
  double depth = 0;           // m; 0 where nothing is touched
  double work = 0;            // J, that the force has done on the hand since the loop began
  bool touching = false;
  std::uint32_t object = LoopTick::kNothing, face = 0, flags = 0;  // that pushes most
};
struct TickBeside {
  LoopTick tick;
  std::array<FeltBeside, 3> felt;  // [kViewMethods]
};

// Follows the HIPs of a loop with all methods, so that their forces are on the very same HIPs. It
// has trackers of its own, and touches nothing of the loop's.
class MethodsBeside {
 public:
  // `has_orientation`: the device's turns the HIPs.
  MethodsBeside(std::vector<SceneObject> objects, const std::vector<Vec3>& hips,
                bool has_orientation = false);

  TickBeside step(const LoopTick& tick) noexcept;
  // Makes all objects feel so, but each tracker keeps its method. False for what a Tracker refuses.
  bool tune(const TuneMessage& tuning) noexcept;

 private:
  std::vector<SceneObject> objects_;
  bool has_orientation_;
  std::vector<Tracker> trackers_;  // [kViewMethods]
  std::array<double, 3> work_{};   // J, that each force has done on the hand
  std::optional<TickBeside> last_;
};

// Makes an object of a tracker feel so from the next step on. False for what the tracker refuses.
bool tune_object(Tracker& tracker, std::size_t object, const TuneMessage& tuning) noexcept;

// Packs ticks as a frame of the socket, little-endian: kFrameMark and the number of ticks as 32-bit
// numbers, the number of the first tick and its time (s) as doubles, then for each tick kRowNumbers
// floats: s since the first, HIP (m), force sent (N), guard's state and reason; and for each method
// force (N), SCP (m), depth (m), 0 free, 1 touching or 2 slipping, object, face and work (mJ).
inline constexpr std::uint32_t kFrameMark = 0x31464c47;  // "GLF1"
inline constexpr std::size_t kRowNumbers = 9 + 3 * 11;
std::string frame_of(std::span<const TickBeside> ticks);

}  // namespace gliss::tools
