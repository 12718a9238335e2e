// One sitting of gliss view: a loop under a hand, the methods beside it, and the pages that watch.
#pragma once

#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gliss/scene/recorder.h"
#include "tools/view/pointer_hand.h"
#include "tools/view/view_run.h"
#include "tools/view/view_server.h"
#include "tools/view/watched_files.h"

namespace gliss::tools {

// The page's choice of how surfaces are built; nothing: as the program's options say.
using BuildChoice = std::optional<BuildMessage>;

struct ViewSetting {
  // Opens what is viewed, in another thread. What it throws ends the session the first time, and is
  // told later on.
  std::function<ViewScene(const BuildChoice& build)> open;
  // Returns the command that shows the same, without its tuning.
  std::function<std::string(const BuildChoice& build)> command;
  // Writes a scene that feels so, and returns its path. What it throws is told.
  std::function<std::string(const BuildChoice& build, const TuneMessage& tuning)> save;
  std::unique_ptr<HapticDevice> device;  // null: the pointer's hand
  SessionOptions session;
  std::string title;  // what is shown
  std::string page, token;
  std::uint16_t port = 0;
  std::string recording;        // begins at once; "": when a page asks
  std::string free_recordings;  // "gliss-view.h5": names of later ones are made of it
  std::string replay;           // a path that is replayed at once; "": when a page asks
  bool watch = false;           // files are read again when they have changed
  std::vector<Attribute> provenance;
};

// A sitting. All of it is one thread's but the loop, and what opens files.
class ViewSession {
 public:
  // Listens, and begins to open: pages that come meanwhile wait. Throws LoopError, and as
  // open_device for a replay.
  explicit ViewSession(ViewSetting setting);
  ~ViewSession();

  const std::string& url() const { return url_; }
  // Serves for a sixtieth of a second, and begins the loop once the scene is open. False once the
  // loop has ended. Throws as `open` and RecordingFile, LoopError, std::invalid_argument.
  bool turn();
  // Ends the loop, and closes a recording.
  void end();

  // Null before the scene is open.
  const LoopSession* loop() const { return run_ ? &run_->loop() : nullptr; }
  const ViewServer::Counts& counts() const { return server_->counts(); }
  std::uint64_t touched() const { return touched_; }                      // ticks in contact
  const std::vector<std::string>& recorded() const { return recorded_; }  // files
  const std::string& failure() const { return failure_; }  // of the last recording, or ""

 private:
  struct Opened {
    ViewScene scene;
    std::vector<SharedPayload> scenery;
  };

  // Messages of the page that steers.
  void follow(const HandMessage& hand);
  void follow(const TuneMessage& wanted);
  void follow(const BuildMessage& build);
  void follow(const RecordMessage& wish);
  void follow(const ReplayMessage& wish);
  void follow(const SaveMessage& wish);
  void follow(const EngageMessage& wish);

  std::vector<SharedPayload> greet(bool steers) const;
  void send_all();
  void send_state();
  SharedPayload hello() const;
  SharedPayload state() const;
  std::string command() const;
  HapticDevice& device();
  void begin_hand(const ViewScene& scene);
  void begin(ViewScene scene);
  void stop_loop();
  void begin_replay(const std::string& path);
  void end_replay();
  void begin_opening(const BuildChoice& build);
  void take_opened();
  void look_at_files();
  static Opened open(const ViewSetting& setting, const BuildChoice& build);
  void begin_recording(const std::string& path);
  void end_recording();
  void lose_recording(const std::exception& error);
  void take_ticks();
  void record();

  ViewSetting setting_;
  BuildChoice build_;  // of what is shown
  std::optional<TuneMessage> tuned_;
  std::unique_ptr<PointerHand> hand_;     // null where there is a device, or no scene yet
  std::unique_ptr<HapticDevice> replay_;  // null where none is under way
  std::unique_ptr<ViewRun> run_;
  std::vector<SharedPayload> scenery_;  // as every page gets it
  BuildChoice opening_;                 // of what is being opened
  std::future<Opened> opened_;
  WatchedFiles files_;
  Nanoseconds began_, next_look_{0};  // the session; the next look at the files
  std::optional<RecordingFile> recording_;
  std::string recording_path_, saved_, failure_, trouble_;
  std::vector<std::string> recorded_;
  std::uint64_t touched_ = 0;
  std::unique_ptr<ViewServer> server_;
  std::string url_;
};

// Returns a name that no file has: "a.h5", "a-2.h5" and so on.
std::string free_name(const std::string& path);

}  // namespace gliss::tools
