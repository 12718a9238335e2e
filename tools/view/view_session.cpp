#include "tools/view/view_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "gliss/surface/names.h"
#include "tools/view/view_geometry.h"

namespace gliss::tools {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kFrameTicks = 64;  // of a frame at most: of more, the last ones

// Names and paths are of any bytes.
SharedPayload text_of(const Json& json) {
  return std::make_shared<const ViewPayload>(
      ViewPayload{true, json.dump(-1, ' ', false, Json::error_handler_t::replace)});
}

Json json_of(const Vec3& vector) { return {vector.x(), vector.y(), vector.z()}; }

TuneMessage tuning_of(const SceneObject& object) {
  return {object.method, object.stiffness, object.friction, object.settle};
}

// A name that no file has: "gliss-view.h5", "gliss-view-2.h5" and so on.
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

// Beside the objects, where nothing is touched.
Vec3 start_of(const std::vector<SceneObject>& objects) {
  const Eigen::AlignedBox3d box = box_of(objects);
  return box.max() + 0.1 * box.diagonal();
}

// Large objects are felt all over in two seconds, small ones no less slowly than a hand can.
double fastest_on(const std::vector<SceneObject>& objects) {
  return std::max(PointerHand::kFastest, 0.5 * box_of(objects).diagonal().norm());
}

}  // namespace

Eigen::AlignedBox3d box_of(const std::vector<SceneObject>& objects) {
  Eigen::AlignedBox3d box;
  for (const SceneObject& object : objects) {
    const Box own = object.cache->bounds();
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner(i & 1 ? own.low.x() : own.high.x(), i & 2 ? own.low.y() : own.high.y(),
                        i & 4 ? own.low.z() : own.high.z());
      box.extend(object.pose * (corner * object.cache->unit));
    }
  }
  return box;
}

ViewSession::ViewSession(ViewSetting setting)
    : setting_(std::move(setting)),
      now_(tuning_of(setting_.objects.front())),
      hand_(start_of(setting_.objects), setting_.hand, fastest_on(setting_.objects)),
      tracker_(setting_.objects, setting_.hips),
      beside_(setting_.objects, setting_.hips) {
  for (std::size_t i = 0; i < setting_.objects.size(); ++i)
    scenery_.push_back(std::make_shared<const ViewPayload>(
        ViewPayload{false, geometry_of(setting_.objects[i], static_cast<std::uint32_t>(i),
                                       kViewTriangles / setting_.objects.size())}));
  server_ = std::make_unique<ViewServer>(
      setting_.port, std::move(setting_.page), std::move(setting_.token),
      ViewEvents{[this](bool steers) { return greet(steers); },
                 [this](const ViewMessage& message) { follow(message); },
                 [] {
                   return text_of({{"steers", true}});
                 }});
  url_ = server_->url();
  if (!setting_.recording.empty()) begin_recording(setting_.recording);
  setting_.session.after_tick = [this, seen = std::uint64_t{0}](Tracker& tracker) mutable {
    apply(tracker, seen);
  };
  loop_ = std::make_unique<LoopSession>(hand_, tracker_, setting_.rules, setting_.session);
}

ViewSession::~ViewSession() { loop_.reset(); }

bool ViewSession::turn() {
  server_->run_for(std::chrono::milliseconds(16));
  take_ticks();
  return !loop_->wait_for(Nanoseconds(0));
}

void ViewSession::end() {
  loop_->request_stop();
  loop_->wait();
  take_ticks();
  if (recording_) {  // of a whole loop, or its end: as gliss run has it
    recording_->add_histogram("wake_lateness", loop_->loop().record().lateness());
    recording_->add_histogram("compute", loop_->loop().record().compute());
  }
  end_recording();
  loop_->join();
}

// Told of an object that does not move.
std::vector<SharedPayload> ViewSession::greet(bool steers) {
  const Eigen::AlignedBox3d box = box_of(setting_.objects);
  Json objects = Json::array();
  for (std::size_t i = 0; i < setting_.objects.size(); ++i) {
    const PatchCache& cache = *setting_.objects[i].cache;
    objects.push_back({{"name", setting_.names[i]},
                       {"faces", cache.mesh_face_count},
                       {"patches", cache.patch_count()},
                       {"surface", surface_name(cache.level)}});
  }
  std::vector<SharedPayload> all;
  all.push_back(
      text_of({{"hello",
                {{"title", setting_.title},
                 {"version", GLISS_VERSION},
                 {"objects", objects},
                 {"min", json_of(box.min())},
                 {"max", json_of(box.max())},
                 {"period", in_seconds(setting_.rules.period)},
                 {"max_force", std::min(hand_.info().max_force, setting_.rules.guard.max_force)},
                 {"max_stiffness", hand_.info().max_stiffness},
                 {"hand_stiffness", setting_.hand.hand_stiffness}}}}));
  all.push_back(state());
  all.push_back(text_of({{"steers", steers}}));
  all.insert(all.end(), scenery_.begin(), scenery_.end());
  return all;
}

std::string ViewSession::command() const {
  return fmt::format("{} --method {} --stiffness {:g}N/m --friction {:g},{:g} --settle {:g}ms",
                     setting_.command, method_name(now_.method), now_.stiffness,
                     now_.friction.at_rest, now_.friction.slipping, 1e3 * now_.settle);
}

SharedPayload ViewSession::state() const {
  return text_of({{"state",
                   {{"method", method_name(now_.method)},
                    {"stiffness", now_.stiffness},
                    {"friction", {now_.friction.at_rest, now_.friction.slipping}},
                    {"settle", now_.settle},
                    {"recording", recording_path_},
                    {"recorded", recorded_},
                    {"failure", failure_},
                    {"command", command()}}}});
}

void ViewSession::send_state() { server_->send(state()); }

void ViewSession::follow(const ViewMessage& message) {
  if (const auto* hand = std::get_if<HandMessage>(&message)) {
    hand_.point(hand->target, monotonic_time());
  } else if (const auto* wanted = std::get_if<TuneMessage>(&message)) {
    tune(*wanted);
  } else if (const auto* wish = std::get_if<RecordMessage>(&message)) {
    record(wish->on);
  } else {
    loop_->request_engage();
  }
}

// What the device does not allow is brought to its limit, and told so by the state.
void ViewSession::tune(TuneMessage wanted) {
  wanted.stiffness = std::min(wanted.stiffness, hand_.info().max_stiffness);
  if (!beside_.tune(wanted.stiffness, wanted.friction, wanted.settle)) return;
  now_ = wanted;
  tunings_.store({++tuned_, wanted.method, wanted.stiffness, wanted.friction.at_rest,
                  wanted.friction.slipping, wanted.friction.settle, wanted.settle});
  send_state();
}

void ViewSession::apply(Tracker& tracker, std::uint64_t& seen) const noexcept {
  const auto latest = tunings_.load(1);
  if (!latest || latest->value.number == seen) return;
  const Tuning& wanted = latest->value;
  FrictionOptions friction;
  friction.at_rest = wanted.at_rest;
  friction.slipping = wanted.slipping;
  friction.settle = wanted.friction_settle;
  seen = wanted.number;
  for (std::size_t i = 0; i < setting_.objects.size(); ++i) {
    tracker.set_material(i, wanted.stiffness, friction);
    if (tracker.is_by(i, wanted.method, wanted.settle)) continue;
    tracker.set_contact(i, wanted.method, wanted.settle);
  }
}

void ViewSession::record(bool on) {
  if (on == recording_.has_value()) return;
  failure_.clear();
  try {
    if (on) {
      begin_recording(free_name(setting_.free_recordings));
    } else {
      end_recording();
    }
  } catch (const std::exception& error) {
    recording_.reset();
    recording_path_.clear();
    failure_ = error.what();
  }
  send_state();
}

void ViewSession::begin_recording(const std::string& path) {
  recording_.emplace(path, setting_.provenance, false);
  recording_path_ = path;
}

void ViewSession::end_recording() {
  if (!recording_) return;
  recording_->close();
  recording_.reset();
  recorded_.push_back(std::exchange(recording_path_, ""));
}

void ViewSession::take_ticks() {
  loop_->take(ticks_);
  // Before the first page there is no hand, and nothing to record.
  std::erase_if(ticks_, [](const LoopTick& tick) { return tick.input.sequence == 0; });
  if (ticks_.empty()) return;
  frame_.clear();
  for (const LoopTick& tick : ticks_) {
    touched_ += tick.touching;
    frame_.push_back(beside_.step(tick));
  }
  if (recording_) {
    try {
      recording_->write(ticks_);
    } catch (const std::exception& error) {  // a full disk, say: the loop goes on
      recording_.reset();
      recording_path_.clear();
      failure_ = error.what();
      send_state();
    }
  }
  if (server_->watching() == 0) return;
  if (frame_.size() > kFrameTicks)
    frame_.erase(frame_.begin(), frame_.end() - static_cast<std::ptrdiff_t>(kFrameTicks));
  server_->send_frame(std::make_shared<const ViewPayload>(ViewPayload{false, frame_of(frame_)}));
}

}  // namespace gliss::tools
