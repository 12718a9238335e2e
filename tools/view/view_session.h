// One sitting of gliss view: a loop under the pointer's hand, the methods beside it, and the pages
// that watch.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gliss/scene/recorder.h"
#include "gliss/scene/session.h"
#include "tools/view/beside.h"
#include "tools/view/pointer_hand.h"
#include "tools/view/view_server.h"

namespace gliss::tools {

struct ViewSetting {
  std::vector<SceneObject> objects;  // each with a cache
  std::vector<std::string> names;    // [object]
  std::vector<Vec3> hips;            // of the tool; empty: one
  LoopOptions rules;
  SimOptions hand;
  SessionOptions session;
  std::string title;    // what is shown
  std::string command;  // that shows it, without its tuning
  std::string page, token;
  std::uint16_t port = 0;
  std::string recording;        // begins at once; "": when a page asks
  std::string free_recordings;  // "gliss-view.h5": names of later ones are made of it
  std::vector<Attribute> provenance;
};

// All of one thread but the loop.
class ViewSession {
 public:
  // Listens, and begins the loop. Throws LoopError, std::invalid_argument, and as RecordingFile.
  explicit ViewSession(ViewSetting setting);
  ~ViewSession();

  const std::string& url() const { return url_; }
  // Serves for a sixtieth of a second. False once the loop has ended.
  bool turn();
  // Ends the loop, and closes a recording.
  void end();

  const LoopSession& loop() const { return *loop_; }
  const ViewServer::Counts& counts() const { return server_->counts(); }
  std::uint64_t touched() const { return touched_; }                      // ticks in contact
  const std::vector<std::string>& recorded() const { return recorded_; }  // files
  const std::string& failure() const { return failure_; }  // of the last recording, or ""

 private:
  struct Tuning {  // a TuneMessage without initializers, as a Seqlock has it
    std::uint64_t number;
    Method method;
    double stiffness, at_rest, slipping, friction_settle, settle;
  };

  std::vector<SharedPayload> greet(bool steers);
  void follow(const ViewMessage& message);
  void tune(TuneMessage wanted);
  void record(bool on);
  void begin_recording(const std::string& path);
  void end_recording();
  void send_state();
  SharedPayload state() const;
  std::string command() const;
  void take_ticks();
  void apply(Tracker& tracker, std::uint64_t& seen) const noexcept;  // in the loop's thread

  ViewSetting setting_;
  TuneMessage now_;
  Seqlock<Tuning> tunings_;
  std::uint64_t tuned_ = 0;
  PointerHand hand_;
  Tracker tracker_;
  MethodsBeside beside_;
  std::vector<SharedPayload> scenery_;  // as every page gets it
  std::optional<RecordingFile> recording_;
  std::string recording_path_, failure_;
  std::vector<std::string> recorded_;
  std::vector<LoopTick> ticks_;
  std::vector<TickBeside> frame_;
  std::uint64_t touched_ = 0;
  std::unique_ptr<ViewServer> server_;
  std::string url_;
  std::unique_ptr<LoopSession> loop_;
};

// The corners of all objects' boxes, m, in the world's frame.
Eigen::AlignedBox3d box_of(const std::vector<SceneObject>& objects);

}  // namespace gliss::tools
