#include "tools/view/view_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "gliss/scene/open_device.h"
#include "gliss/surface/names.h"
#include "tools/view/view_geometry.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr std::size_t kFrameTicks = 64;    // of a frame at most: of more, the last ones
constexpr Nanoseconds kLookEvery = 300ms;  // at files

// Names and paths are of any bytes.
SharedPayload text_of(const Json& json) {
  return std::make_shared<const ViewPayload>(
      ViewPayload{true, json.dump(-1, ' ', false, Json::error_handler_t::replace)});
}

Json json_of(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json json_of(const TextureOptions& texture) {
  return {{"kind", texture.any() ? name_of(kReliefNames, texture.relief) : "none"},
          {"height", texture.height},
          {"period", texture.period}};
}

// Returns m/s: large objects are felt all over in two seconds, and on none is the hand slower than
// one that feels its way.
double fastest_on(const std::vector<SceneObject>& objects) {
  return std::max(PointerHand::kFastest, 0.5 * box_of(objects).diagonal().norm());
}

// Returns a place beside the objects, where nothing is touched.
Vec3 start_of(const std::vector<SceneObject>& objects) {
  const Eigen::AlignedBox3d box = box_of(objects);
  return box.max() + 0.1 * box.diagonal();
}

}  // namespace

std::string free_name(const std::string& path) {
  const std::filesystem::path first(path);
  std::string name = path;
  for (int i = 2; std::filesystem::exists(name); ++i) {
    const std::string numbered =
        fmt::format("{}-{}{}", first.stem().string(), i, first.extension().string());
    name = (first.parent_path() / numbered).string();
  }
  return name;
}

ViewSession::Opened ViewSession::open(const ViewSetting& setting, const BuildChoice& build) {
  Opened opened{setting.open(build), {}};
  const std::vector<SceneObject>& objects = opened.scene.objects;
  for (std::size_t i = 0; i < objects.size(); ++i)
    opened.scenery.push_back(std::make_shared<const ViewPayload>(ViewPayload{
        false,
        geometry_of(objects[i], static_cast<std::uint32_t>(i), kViewTriangles / objects.size())}));
  return opened;
}

ViewSession::ViewSession(ViewSetting setting)
    : setting_(std::move(setting)), began_(monotonic_time()) {
  if (!setting_.replay.empty()) begin_replay(setting_.replay);
  const auto steered = [this](const ViewMessage& message) {
    if (run_) std::visit([this](const auto& wish) { follow(wish); }, message);
  };
  const auto promoted = [] { return text_of({{"steers", true}}); };
  server_ = std::make_unique<ViewServer>(
      setting_.port, std::move(setting_.page), std::move(setting_.token),
      ViewEvents{[this](bool steers) { return greet(steers); }, steered, promoted});
  url_ = server_->url();
  begin_opening(build_);
}

ViewSession::~ViewSession() { run_.reset(); }

bool ViewSession::turn() {
  server_->run_for(16ms);
  take_opened();
  if (!run_) return true;
  take_ticks();
  if (setting_.watch) look_at_files();
  if (!run_->loop().wait_for(0ns)) return true;
  if (!replay_) return false;
  end_replay();
  return true;
}

void ViewSession::look_at_files() {
  const Nanoseconds now = monotonic_time();
  if (now < next_look_ || opened_.valid()) return;
  next_look_ = now + kLookEvery;
  if (files_.changed()) begin_opening(build_);
}

void ViewSession::end() {
  if (run_) stop_loop();
  end_recording();
  if (run_) run_->loop().join();
}

HapticDevice& ViewSession::device() {
  if (replay_) return *replay_;
  return setting_.device ? *setting_.device : *hand_;
}

void ViewSession::begin_hand(const ViewScene& scene) {
  if (setting_.device) return;
  hand_ =
      std::make_unique<PointerHand>(start_of(scene.objects), scene.hand, fastest_on(scene.objects));
}

// Begins a loop of its own, whose ticks are counted from 0.
void ViewSession::begin(ViewScene scene) {
  if (tuned_) tune(scene, *tuned_);
  run_.reset();  // its device is this one's
  SessionOptions session = setting_.session;
  if (session.seconds > 0)  // of all loops together
    session.seconds = std::max(1e-3, session.seconds - in_seconds(monotonic_time() - began_));
  run_ = std::make_unique<ViewRun>(std::move(scene), device(), session);
}

// The guard takes the force away first.
void ViewSession::stop_loop() {
  run_->loop().request_stop();
  run_->loop().wait();
  take_ticks();
  if (!recording_) return;
  recording_->add_histogram("wake_lateness", loop()->loop().record().lateness());
  recording_->add_histogram("compute", loop()->loop().record().compute());
}

SharedPayload ViewSession::hello() const {
  const ViewScene& scene = run_->scene();
  const Eigen::AlignedBox3d box = box_of(scene.objects);
  const DeviceInfo& info = setting_.device ? setting_.device->info() : hand_->info();
  Json objects = Json::array();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const PatchCache& cache = *scene.objects[i].cache;
    objects.push_back({{"name", scene.names[i]},
                       {"faces", cache.mesh_face_count},
                       {"patches", cache.patch_count()},
                       {"surface", surface_name(cache.level)}});
  }
  return text_of({{"hello",
                   {{"title", setting_.title},
                    {"version", GLISS_VERSION},
                    {"objects", objects},
                    {"min", json_of(box.min())},
                    {"max", json_of(box.max())},
                    {"period", in_seconds(scene.rules.period)},
                    {"device", setting_.device ? info.name : ""},
                    {"max_force", std::min(info.max_force, scene.rules.guard.max_force)},
                    {"max_stiffness", scene.max_stiffness},
                    {"hand_stiffness", scene.hand.hand_stiffness}}}});
}

std::vector<SharedPayload> ViewSession::greet(bool steers) const {
  const SharedPayload steering = text_of({{"steers", steers}});
  if (!run_) return {text_of({{"opens", setting_.title}}), steering};
  std::vector<SharedPayload> all{hello(), state(), steering};
  all.insert(all.end(), scenery_.begin(), scenery_.end());
  return all;
}

// Tells all pages what they show from now on.
void ViewSession::send_all() {
  server_->send(hello());
  send_state();
  for (const SharedPayload& payload : scenery_) server_->send(payload);
}

std::string ViewSession::command() const {
  const TuneMessage now = tuning_of(run_->scene());
  std::string text =
      fmt::format("{} --method {} --stiffness {:g}N/m --friction {:g},{:g} --settle {:g}ms",
                  setting_.command(build_), method_name(now.method), now.stiffness,
                  now.friction.at_rest, now.friction.slipping, 1e3 * now.settle);
  if (now.texture.any())
    text += fmt::format(" --texture {},{:g}um,{:g}mm", name_of(kReliefNames, now.texture.relief),
                        1e6 * now.texture.height, 1e3 * now.texture.period);
  return text;
}

SharedPayload ViewSession::state() const {
  const TuneMessage now = tuning_of(run_->scene());
  const Level& level = run_->scene().objects.front().cache->level;
  return text_of({{"state",
                   {{"method", method_name(now.method)},
                    {"stiffness", now.stiffness},
                    {"friction", {now.friction.at_rest, now.friction.slipping}},
                    {"settle", now.settle},
                    {"texture", json_of(now.texture)},
                    {"level", level_name(level)},
                    {"construction", construction_name(level.construction)},
                    {"crease", build_ && build_->crease ? Json(*build_->crease) : Json()},
                    {"opening", opened_.valid()},
                    {"recording", recording_path_},
                    {"recorded", recorded_},
                    {"replaying", replay_ != nullptr},
                    {"saved", saved_},
                    {"failure", failure_.empty() ? trouble_ : failure_},
                    {"command", command()}}}});
}

void ViewSession::send_state() { server_->send(state()); }

// A device is moved by nobody but the hand that holds it.
void ViewSession::follow(const HandMessage& hand) {
  if (hand_) hand_->point(hand.target, monotonic_time());
}

// Brings what the device does not allow to its limit, which the state then tells.
void ViewSession::follow(const TuneMessage& wanted) {
  TuneMessage allowed = wanted;
  allowed.stiffness = std::min(wanted.stiffness, run_->scene().max_stiffness);
  if (!run_->tune(allowed)) return;
  tuned_ = allowed;
  send_state();
}

void ViewSession::follow(const BuildMessage& build) { begin_opening(build); }

void ViewSession::follow(const EngageMessage&) { run_->loop().request_engage(); }

void ViewSession::follow(const SaveMessage&) {
  trouble_.clear();
  try {
    saved_ = setting_.save(build_, tuning_of(run_->scene()));
  } catch (const std::exception& error) {
    trouble_ = error.what();
  }
  send_state();
}

void ViewSession::follow(const RecordMessage& wish) {
  if (wish.on == recording_.has_value()) return;
  failure_.clear();
  try {
    if (wish.on) {
      begin_recording(free_name(setting_.free_recordings));
    } else {
      end_recording();
    }
  } catch (const std::exception& error) {
    lose_recording(error);
  }
  send_state();
}

void ViewSession::follow(const ReplayMessage& wish) {
  if (wish.on == (replay_ != nullptr) || setting_.device) return;
  if (!wish.on) return run_->loop().request_stop();  // turn() sees its end
  const std::string& path = recorded_.empty() ? setting_.replay : recorded_.back();
  trouble_ = path.empty() ? "there is no recording yet" : "";
  try {
    if (!path.empty()) {
      begin_replay(path);
      stop_loop();
      end_recording();
      begin(run_->scene());
    }
  } catch (const std::exception& error) {
    trouble_ = error.what();
  }
  send_all();
}

void ViewSession::begin_replay(const std::string& path) {
  replay_ = open_device("replay:" + path, {}, {.name = "replay"});
}

void ViewSession::end_replay() {
  stop_loop();
  end_recording();
  const ViewScene scene = run_->scene();
  run_.reset();
  replay_.reset();
  begin(scene);
  send_all();
}

// Opens in another thread, beside a loop that there is; a choice that comes meanwhile is not heard.
void ViewSession::begin_opening(const BuildChoice& build) {
  if (opened_.valid()) return;
  opening_ = build;
  opened_ = std::async(std::launch::async, [this, build] { return open(setting_, build); });
  if (run_) send_state();
}

void ViewSession::take_opened() {
  if (!opened_.valid() || opened_.wait_for(0ns) != std::future_status::ready) return;
  trouble_.clear();
  try {
    auto [scene, scenery] = opened_.get();
    if (run_) {
      stop_loop();
      end_recording();
    } else {
      begin_hand(scene);
      if (!setting_.recording.empty()) begin_recording(setting_.recording);
    }
    scenery_ = std::move(scenery);
    build_ = opening_;
    files_.watch(scene.files);
    begin(std::move(scene));
    send_all();
  } catch (const std::exception& error) {
    if (!run_) throw;
    trouble_ = error.what();
    send_state();
  }
}

void ViewSession::begin_recording(const std::string& path) {
  recording_.emplace(path, setting_.provenance,
                     setting_.device && setting_.device->info().has_orientation);
  recording_path_ = path;
}

void ViewSession::end_recording() {
  if (!recording_) return;
  recording_->close();
  recording_.reset();
  recorded_.push_back(std::exchange(recording_path_, ""));
}

// A full disk, say, ends the recording, and the loop goes on.
void ViewSession::record() {
  if (!recording_) return;
  try {
    recording_->write(run_->ticks());
  } catch (const std::exception& error) {
    lose_recording(error);
    send_state();
  }
}

void ViewSession::lose_recording(const std::exception& error) {
  recording_.reset();
  recording_path_.clear();
  failure_ = error.what();
}

void ViewSession::take_ticks() {
  run_->take();
  if (run_->ticks().empty()) return;
  for (const LoopTick& tick : run_->ticks()) touched_ += tick.touching;
  record();
  if (server_->watching() == 0) return;
  std::span<const TickBeside> frame = run_->frame();
  if (frame.size() > kFrameTicks) frame = frame.last(kFrameTicks);
  server_->send_frame(std::make_shared<const ViewPayload>(ViewPayload{false, frame_of(frame)}));
}

}  // namespace gliss::tools
