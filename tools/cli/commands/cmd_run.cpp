// gliss run: a scene under a device, 1000 times a second. The keys of its JSON are a contract.
#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <optional>

#include "gliss/files/atomic_file.h"
#include "gliss/scene/open_scene.h"
#include "gliss/scene/recorder.h"
#include "gliss/scene/session.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/commands/run_progress.h"
#include "tools/cli/commands/scene_device.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/outputs.h"
#include "tools/cli/words/scene_input.h"
#include "tools/cli/words/shape_text.h"
#include "tools/cli/words/slips.h"
#include "tools/cli/words/surface_input.h"
#include "tools/cli/words/timing_text.h"

namespace gliss::tools {
namespace {

using namespace std::chrono_literals;

struct RunOptions : ReportOptions {
  int threads = 0, cpu = -1;
  std::string scene, device = "sim", recording, summary;
  double seconds = 0;  // 0: until the device ends
  bool no_wait = false, require_realtime = false, cpu_time = false, has_old_summary = false;
};

void describe(Command& command, RunOptions& options) {
  add_scene_option(command, options.scene, "scene file (.toml)");
  add_device_option(command, options.device);
  command.flag("--no-wait", options.no_wait,
               "run ticks as fast as possible, in simulated time; for sim and replay");
  command.option({"--seconds", "SECONDS", "end after this time; default: when the device ends"},
                 options.seconds, 1e-3, 1e7);
  add_record_option(command, "record each tick", options.recording);
  command.option({"--summary", "FILE",
                  "write a summary as JSON: figures, histograms, the ticks before each trip"},
                 options.summary);
  command.option({"--report", "FILE", "the old name of --summary, which will go with 0.3"},
                 [&](const std::string& path) {
                   options.summary = path;
                   options.has_old_summary = true;
                 });
  command.option({"--threads", "N", "threads to build patches with; 0, the default: all"},
                 options.threads, 0, 4096);
  add_cpu_option(command, options.cpu);
  command.flag("--cpu-time", options.cpu_time,
               "time the ticks by the thread's CPU clock, blind to pre-emption: two system calls "
               "more a tick");
  command.flag("--require-rt", options.require_realtime,
               "make it an error where real-time scheduling or locked memory is refused");
}

struct Outcome {
  RunReport report;
  LoopEnd end = LoopEnd::kStopped;
  SessionGrants grants;
  std::uint64_t lost = 0;           // ticks that the session had no room for
  std::exception_ptr not_recorded;  // why

  std::string scheduling() const {
    return grants.priority > 0 ? fmt::format("SCHED_FIFO {}", grants.priority) : "SCHED_OTHER";
  }
};

// The ticks of a loop that ends after so many seconds; 0: unknown.
std::uint64_t ticks_of(const RunOptions& options, const Scene& scene) {
  return static_cast<std::uint64_t>(std::ceil(options.seconds / in_seconds(scene.loop.period)));
}

// Hands ticks to the recording. A recording that fails does not stop the loop while a hand is on
// the device; with --no-wait there is no hand, and it is an error.
void record(const std::vector<LoopTick>& ticks, const RunOptions& options, RunProgress& progress,
            std::optional<RecordingFile>& recording, Outcome& outcome) {
  if (!recording) return;
  try {
    recording->write(ticks);
  } catch (const std::exception& error) {
    if (options.no_wait) throw;
    recording.reset();
    outcome.not_recorded = std::current_exception();
    progress.say(fmt::format("{}; the loop goes on", error.what()));
  }
}

// Records and tells until the session ends.
Outcome follow(LoopSession& session, const RunOptions& options, const Scene& scene,
               std::optional<RecordingFile>& recording) {
  Outcome outcome;
  RunProgress progress(options.quiet, options.no_wait, ticks_of(options, scene));
  std::uint64_t taken = 0;
  std::vector<LoopTick> ticks;
  for (bool more = true, told = options.quiet; more;) {
    more = !session.wait_for(options.no_wait ? 1ms : 50ms);
    if (interrupted()) session.request_stop();
    if (const auto grants = session.grants(); grants && !told) {
      for (const std::string& line : grants->refusals) tell(fmt::format("gliss: {}\n", line));
      told = true;
    }
    session.take(ticks);
    taken += ticks.size();
    for (const LoopTick& tick : ticks) outcome.report.add(tick);
    record(ticks, options, progress, recording, outcome);
    if (more) progress.update(outcome.report, taken);
  }
  progress.finish(outcome.report, taken);
  session.join();
  outcome.end = session.end();
  outcome.grants = session.grants().value();
  outcome.lost = outcome.not_recorded ? session.loop().record().ticks() : session.lost();
  return outcome;
}

// [{mesh, stiffness_N_per_m}]
Json objects_json(const Scene& scene) {
  Json objects = Json::array();
  for (const ObjectDescription& object : scene.objects)
    objects.push_back({{"mesh", object.surface}, {"stiffness_N_per_m", object.stiffness}});
  return objects;
}

Json figures_of(const RunOptions& options, const Scene& scene, const HapticLoop& loop,
                const Outcome& outcome, const std::string& device) {
  const TickRecord& record = loop.record();
  const ForceStatistics &rendered = outcome.report.rendered(), &sent = outcome.report.sent();
  Json acts = Json::object();
  std::uint64_t trips = 0;
  for (int i = 1; i < kGuardReasons; ++i) {
    const auto reason = static_cast<GuardReason>(i);
    acts[guard_reason_name(reason)] = loop.guard().count(reason);
    if (is_failure(reason)) trips += loop.guard().count(reason);
  }
  return {{"command_line", command_line()},
          {"scene", options.scene},
          {"objects", objects_json(scene)},
          {"ticks", record.ticks()},
          {"missed", record.missed()},
          {"largest_force_step", rendered.largest_step},
          {"jumps_per_100k", rendered.jumps_per_100k()},
          {"lost_per_100k", rendered.lost_per_100k()},
          {"unsound", rendered.unsound + sent.unsound},
          {"p50_us", microseconds(record.compute().quantile(0.5))},
          {"p99_us", microseconds(record.compute().quantile(0.99))},
          {"guard_trips", trips},
          {"guards", acts},
          {"mean_force_step", rendered.mean_step},
          {"largest_force", rendered.largest_force},
          {"in_contact", rendered.touching},
          {"entries", rendered.entries},
          {"settling", rendered.settling},
          {"largest_sent_step", sent.largest_step},
          {"sent_jumps_per_100k", sent.jumps_per_100k()},
          {"sent_lost_per_100k", sent.lost_per_100k()},
          {"largest_sent_force", sent.largest_force},
          {"success_rate", record.success()},
          {"longest_missed", record.longest_missed()},
          {"wake", json_of(record.lateness())},
          {"compute", json_of(record.compute())},
          {"device", device},
          {"end", loop_end_text(outcome.end)},
          {"scheduling", outcome.scheduling()},
          {"memory_locked", outcome.grants.memory_locked},
          {"refusals", outcome.grants.refusals},
          {"ticks_not_recorded", outcome.lost}};
}

std::string steps_text(const ForceStatistics& s) {
  return fmt::format(
      "force up to {:.3f} N, largest step {:.4f} N, jumps {:.1f} and lost {:.1f} per 100,000 ticks "
      "in contact of this motion",
      s.largest_force, s.largest_step, s.jumps_per_100k(), s.lost_per_100k());
}

std::string text_of(const HapticLoop& loop, const Outcome& outcome, const Json& json) {
  const TickRecord& record = loop.record();
  const ForceStatistics &rendered = outcome.report.rendered(), &sent = outcome.report.sent();
  std::string out =
      timing_header() + timing_row("wake", record.lateness()) +
      timing_row("compute", record.compute()) +
      fmt::format("{} ticks, {} missed, at most {} in a row; success {:.3f} %; {}, memory {}\n",
                  record.ticks(), record.missed(), record.longest_missed(), 100 * record.success(),
                  outcome.scheduling(), outcome.grants.memory_locked ? "locked" : "not locked") +
      fmt::format("rendered: {} ticks in contact, {} entries, {}\nsent: {}\n", rendered.touching,
                  rendered.entries, steps_text(rendered), steps_text(sent)) +
      unsound_text(rendered.unsound + sent.unsound, "steps") + "guards:";
  std::string acts;
  for (const auto& [reason, count] : json["guards"].items()) {
    // Each loop that ends well ends by that.
    const bool is_end = reason == guard_reason_name(GuardReason::kStopRequested);
    if (count != 0 && !is_end) acts += fmt::format(" {} {}x,", reason, count.get<std::uint64_t>());
  }
  if (!acts.empty()) acts.pop_back();
  out += acts.empty() ? " none acted" : acts;
  if (outcome.lost > 0) out += fmt::format("\n{} ticks were not recorded", outcome.lost);
  return fmt::format("{}\nend: {}\n", out, loop_end_text(outcome.end));
}

// Says which objects curve tighter than a HIP was deep in them. Lazy ones do not know. The report
// has the objects once for each HIP.
void tell_tight_objects(const RunOptions& options, const Scene& scene,
                        const std::vector<SceneObject>& objects, const RunReport& report) {
  std::vector<double> deepest(objects.size(), 0);
  for (std::size_t i = 0; i < report.deepest().size(); ++i) {
    double& of_object = deepest[i % objects.size()];
    of_object = std::max(of_object, report.deepest()[i]);
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].cache != nullptr && objects[i].method == Method::kGregory)
      tell_tight_curvature(options, *objects[i].cache, deepest[i], "the deepest contact",
                           scene.objects[i].surface);
  }
}

// The objects that are there as a whole, in metres of the world.
std::vector<Box> boxes_of(const std::vector<SceneObject>& objects) {
  std::vector<Box> boxes;
  for (const SceneObject& object : objects) {
    if (object.cache == nullptr) continue;
    const Eigen::AlignedBox3d box = box_of(object);
    boxes.push_back({box.min(), box.max()});
  }
  return boxes;
}

// Points of the path that the simulated hand follows, m.
std::vector<Vec3> points_of(HandPath path) {
  constexpr int kPoints = 1000;
  std::vector<Vec3> points;
  for (int i = 0; i <= kPoints; ++i) points.push_back(path.at(path.duration() * i / kPoints));
  return points;
}

// Says that a hand has felt nothing, and of a replay and a simulated hand how far off it was.
void tell_untouched_objects(const RunOptions& options, const Scene& scene,
                            const std::vector<SceneObject>& objects) {
  if (options.quiet) return;
  const std::vector<Box> boxes = boxes_of(objects);
  if (options.device == "sim" && !boxes.empty()) {
    tell_untouched(options, options.scene, points_of(scene.sim_path), boxes,
                   "write \"40mm\" for 40");
    return;
  }
  const std::string path = replayed_file(options.device);
  if (path.empty()) {
    tell("gliss: the hand touched nothing: do its ways lead into an object?\n");
    return;
  }
  tell_untouched(options, path, points_in_metres(read_points(path, 1, {}, stop_if_interrupted)),
                 boxes, "name the columns x_mm,y_mm,z_mm");
}

// Says where the force is so late, by half a tick and the delay of what is read, that it asks for
// more damping than a simulated hand has (docs/scenes.md).
void tell_swinging_hand(const RunOptions& options, const Scene& scene, const LoopOptions& rules) {
  if (options.quiet || options.device != "sim") return;
  const double tick = in_seconds(rules.period), delay = in_seconds(scene.sim->delay);
  for (const ObjectDescription& object : scene.objects) {
    const double asked = object.stiffness * (tick / 2 + delay);
    if (asked <= scene.sim->hand_damping) continue;
    tell(fmt::format(
        "gliss: {}: {:g} N/m at {:g} ticks a second, with {:g} ms of delay, ask for "
        "{:.3g} N s/m of damping, and the hand has {:g}: it will swing; cure: a lower "
        "stiffness, a higher rate or less delay\n",
        object.place, object.stiffness, 1 / tick, 1e3 * delay, asked, scene.sim->hand_damping));
  }
}

std::vector<Attribute> provenance(const RunOptions& options, const Scene& scene,
                                  const HapticDevice& device) {
  return {{"program", "gliss"},
          {"version", GLISS_VERSION},
          {"command_line", command_line()},
          {"scene", options.scene},
          {"device", device.info().name},
          {"objects", objects_json(scene).dump(-1, ' ', false, Json::error_handler_t::replace)}};
}

// The files that a run leaves. They are opened before the loop begins.
struct RunFiles {
  RunFiles(const RunOptions& options, const Scene& scene, const HapticDevice& device) {
    if (!options.recording.empty())
      recording.emplace(options.recording, provenance(options, scene, device),
                        device.info().has_orientation);
    if (!options.summary.empty()) summary.emplace(options.summary);
  }

  std::optional<RecordingFile> recording;
  std::optional<AtomicFile> summary;
};

// Completes both files, and gives the first failure of the recording and of these, or null.
std::exception_ptr complete(RunFiles& files, const TickRecord& record, const Outcome& outcome,
                            const Json& figures) {
  std::exception_ptr failed = outcome.not_recorded;
  const auto attempt = [&](const auto& write) {
    try {
      write();
    } catch (const std::exception&) {
      if (!failed) failed = std::current_exception();
    }
  };
  attempt([&] {
    if (!files.recording) return;
    files.recording->add_histogram("wake_lateness", record.lateness());
    files.recording->add_histogram("compute", record.compute());
    files.recording->close();
  });
  attempt([&] {
    if (!files.summary) return;
    Json whole = figures;
    whole["histograms"] = histograms_json(record);
    whole["trips"] = outcome.report.trips_json();
    files.summary->write(printed(whole));
    files.summary->commit();
  });
  return failed;
}

void tell_odd_objects(const RunOptions& options, const Scene& scene,
                      const std::vector<SceneObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectDescription& described = scene.objects[i];
    tell_soft_spring(options, objects[i].stiffness, described.surface);
    if (described.patches == Patches::kLazy && objects[i].lazy == nullptr && !options.quiet)
      tell(
          fmt::format("gliss: {}: its parts lie within one another or fold, and what is inside "
                      "asks all patches: all were built, none lazily\n",
                      described.surface));
  }
}

// A touch takes about a microsecond.
void tell_crowd(const RunOptions& options, std::size_t contacts, const LoopOptions& rules) {
  const auto fit = static_cast<std::size_t>(in_seconds(rules.period) * 1e6);
  if (contacts <= fit || options.quiet || !rules.wait) return;
  tell(fmt::format(
      "gliss: {} contacts of objects and HIPs: where more than about {} of them touch at once a "
      "tick takes longer than its period, and the guard ends the force\n",
      contacts, fit));
}

void run(const RunOptions& options) {
  if (options.has_old_summary && !options.quiet)
    tell("gliss: --report: the summary is --summary now; the old name will go\n");
  const Scene scene = read_scene(options.scene, stop_if_interrupted);
  std::vector<std::string> inputs = scene.files;
  inputs.push_back(replayed_file(options.device));
  check_outputs({options.recording, options.summary}, inputs);
  const std::vector<SceneObject> objects =
      open_scene_objects(scene, options.threads, options.quiet);
  tell_odd_objects(options, scene, objects);
  const auto device = open_scene_device(options.device, scene);
  LoopOptions rules = loop_options(scene, device->info());
  tell_swinging_hand(options, scene, rules);
  if (options.no_wait && device->info().real_time)
    throw InputError(fmt::format("--no-wait: {} lives in real time", device->info().name));
  RunFiles files(options, scene, *device);

  const std::vector<Vec3> hips = open_hips(scene, {.poll = stop_if_interrupted});
  Tracker tracker(objects, hips);
  rules.wait = !options.no_wait;
  tell_crowd(options, objects.size() * std::max<std::size_t>(1, hips.size()), rules);
  rules.cpu_time = options.cpu_time;
  LoopSession session(
      *device, tracker, rules,
      {options.seconds, true, {scene.priority, options.require_realtime, options.cpu}});
  const Outcome outcome = follow(session, options, scene, files.recording);

  const HapticLoop& loop = session.loop();
  Json json = figures_of(options, scene, loop, outcome, device->info().name);
  if (device->info().has_orientation) json["largest_torque_Nm"] = outcome.report.largest_torque();
  const std::exception_ptr failed = complete(files, loop.record(), outcome, json);
  tell_tight_objects(options, scene, objects, outcome.report);
  if (outcome.report.rendered().touching == 0 && loop.record().ticks() > 0)
    tell_untouched_objects(options, scene, objects);
  if (outcome.report.begins_inside() && !options.quiet)
    tell(
        fmt::format("gliss: the hand begins inside an object: until it has been outside, the "
                    "force is at most {:g} N\n",
                    rules.guard.engage_below));
  report(options, text_of(loop, outcome, json), json);
  if (failed) std::rethrow_exception(failed);
  stop_if_interrupted();
  if (outcome.end == LoopEnd::kDeviceFault)
    throw LoopError(fmt::format("{}: {}", device->info().name, device->fault_text()));
}

}  // namespace

void add_run(Command& program) {
  add_command<RunOptions>(
      program, "run",
      "Run a scene under a device, 1000 times a second.\n"
      "largest_force_step: of the force as rendered, from tick to tick, as gliss trace has it: "
      "gaining and losing contact are steps from zero and to zero. jumps_per_100k: ticks whose "
      "step is above 20 % of the force held lately, lost_per_100k: contacts that end under more "
      "than that, each per 100,000 ticks in contact; unsound: steps that are not finite. "
      "success_rate: the share of the periods that had a tick without an error; a period that was "
      "missed and a tick in which a guard acted on a failure have none. "
      "largest_sent_step: of what went to the device. guard_trips: times that a guard acted on a "
      "late input, numbers that are not finite, a clock or the device.",
      "gliss run scene.toml --device sim --record run.h5", describe, run);
}

}  // namespace gliss::tools
