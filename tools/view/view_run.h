// The objects that gliss view shows, and one loop among them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "gliss/device/sim_device.h"
#include "gliss/scene/session.h"
#include "gliss/thread/seqlock.h"
#include "tools/view/beside.h"
#include "tools/view/view_protocol.h"

namespace gliss::tools {

// Objects, and the rules under which a hand touches them.
struct ViewScene {
  std::vector<SceneObject> objects;  // each with a cache
  std::vector<std::string> names;    // [object]
  std::vector<Vec3> hips;            // of the tool; empty: one
  LoopOptions rules;
  SimOptions hand;                 // the pointer's
  double max_stiffness = 2000;     // N/m, that a page may choose
  std::vector<std::string> files;  // that it was read from
};

// The box of all objects, m, in the world's frame.
Eigen::AlignedBox3d box_of(const std::vector<SceneObject>& objects);

// Returns how the first object feels; all others may feel otherwise until a page tunes them.
TuneMessage tuning_of(const ViewScene& scene);
// Makes all objects feel so.
void tune(ViewScene& scene, const TuneMessage& tuning);

// A loop under a device, from its first tick to its last. All but the loop is one thread's.
class ViewRun {
 public:
  // Begins the loop. The device outlives it. Throws std::invalid_argument.
  ViewRun(ViewScene scene, HapticDevice& device, SessionOptions session);
  ~ViewRun() { loop_.reset(); }
  ViewRun(const ViewRun&) = delete;
  ViewRun& operator=(const ViewRun&) = delete;

  const ViewScene& scene() const { return scene_; }
  LoopSession& loop() { return *loop_; }
  const LoopSession& loop() const { return *loop_; }
  // Makes all objects feel so from the next tick on. False for what a Tracker refuses.
  bool tune(const TuneMessage& tuning);
  // Takes the ticks since the last call that have a HIP: ticks() and, beside them, frame().
  void take();
  const std::vector<LoopTick>& ticks() const { return ticks_; }
  const std::vector<TickBeside>& frame() const { return frame_; }

 private:
  struct Tuning {  // a TuneMessage without initializers, as a Seqlock has it
    Method method;
    double stiffness, at_rest, slipping, friction_settle, settle;
    Relief relief;
    double height, period;
  };

  void apply(Tracker& tracker, std::uint64_t& seen) const noexcept;  // in the loop's thread

  ViewScene scene_;
  Seqlock<Tuning> tunings_;
  Tracker tracker_;
  MethodsBeside beside_;
  std::vector<LoopTick> ticks_;
  std::vector<TickBeside> frame_;
  std::unique_ptr<LoopSession> loop_;
};

}  // namespace gliss::tools
