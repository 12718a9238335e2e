// The device loop in a thread of its own, from which Python reads ticks.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <atomic>
#include <optional>

#include "arrays.h"
#include "calls.h"
#include "errors.h"
#include "gliss/engine/engine.h"
#include "gliss/haply/haply_device.h"
#include "gliss/scene/open_device.h"
#include "gliss/scene/open_scene.h"
#include "gliss/scene/session.h"
#include "options.h"
#include "surface.h"

namespace gliss::python {
namespace {

using namespace std::chrono_literals;

// A row of what Loop.read gives, in SI.
struct TickRow {
  std::uint64_t number;
  double time, lateness, compute, age;
  std::uint64_t missed;
  double position[3], orientation[4], rendered[3], sent[3], rendered_torque[3], sent_torque[3];
  char guard[16], reason[24];
  std::int32_t object;
  bool touching;
  std::uint32_t face;
  double distance;
  std::int32_t iterations;
  std::uint32_t flags;
};

TickRow row_of(const LoopTick& tick) {
  TickRow row{};
  row.number = tick.number;
  row.time = in_seconds(tick.time);
  row.lateness = in_seconds(tick.lateness);
  row.compute = in_seconds(tick.compute);
  row.age = in_seconds(tick.age);
  row.missed = tick.missed;
  const auto copy = [](const Vec3& from, double* to) { std::copy_n(from.data(), 3, to); };
  copy(tick.input.position, row.position);
  const Rotation& turn = tick.input.orientation;
  const double parts[] = {turn.w(), turn.x(), turn.y(), turn.z()};
  std::copy_n(parts, 4, row.orientation);
  copy(tick.rendered, row.rendered);
  copy(tick.sent, row.sent);
  copy(tick.rendered_torque, row.rendered_torque);
  copy(tick.sent_torque, row.sent_torque);
  std::string(guard_state_name(tick.state)).copy(row.guard, sizeof row.guard);
  std::string(guard_reason_name(tick.reason)).copy(row.reason, sizeof row.reason);
  row.object = tick.object == LoopTick::kNothing ? -1 : static_cast<std::int32_t>(tick.object);
  row.touching = tick.touching;
  row.face = tick.face;
  row.distance = tick.distance;
  row.iterations = tick.iterations;
  row.flags = tick.flags;
  return row;
}

class Loop {
 public:
  Loop(const std::string& path, const std::string& device, double seconds, bool wait, bool realtime,
       int threads, int cpu) {
    if (!(seconds >= 0 && seconds <= 1e7))
      throw py::value_error(fmt::format("seconds: {} is not from 0 to 1e7", seconds));
    check_file(path);
    released([&] {
      const Scene scene = read_scene(path, poll);
      const auto engine = make_tbb_engine(threads, poll);
      SceneOpening opening;
      opening.build = [&](const Mesh& mesh, const BuildOptions& options) {
        return engine->build(mesh, options);
      };
      opening.poll = poll;
      const std::vector<SceneObject> objects = open_objects(scene, opening);
      device_ = open_device(device, scene,
                            {.poll = poll,
                             .realtime = realtime,
                             .open_other = open_haply,
                             .other_words = kHaplyWords});
      if (!wait && device_->info().real_time)
        throw py::value_error(fmt::format("wait: {} lives in real time", device_->info().name));
      LoopOptions rules = loop_options(scene, device_->info());
      rules.wait = wait;
      tracker_.emplace(objects, open_hips(scene, opening));
      session_.emplace(*device_, *tracker_, rules,
                       SessionOptions{seconds, realtime, {scene.priority, false, cpu}});
    });
  }
  ~Loop() {
    if (abandoned_) (void)device_.release();
  }

  py::array_t<TickRow> read() {
    require_open();
    std::vector<LoopTick> ticks;
    session_->take(ticks);
    py::array_t<TickRow> rows(static_cast<py::ssize_t>(ticks.size()));
    std::transform(ticks.begin(), ticks.end(), rows.mutable_data(), row_of);
    return rows;
  }
  // True once the loop has ended.
  bool wait(std::optional<double> timeout) {
    require_open();
    if (timeout && !(*timeout >= 0))
      throw py::value_error(fmt::format("timeout: {} s is not 0 or more", *timeout));
    return released([&] {
      const Nanoseconds start = monotonic_time();
      while (!session_->wait_for(5ms)) {
        if (timeout && in_seconds(monotonic_time() - start) >= *timeout) return false;
        poll();
      }
      return true;
    });
  }
  // Ends it, however it does.
  void stop() {
    session_->request_stop();
    session_->wait();
  }
  // For a child of fork(), which has no thread of the loop, and whose parent has the device: what
  // would wait for the one or write to the other is left as it is.
  void abandon() {
    closed_ = abandoned_ = true;
    session_->abandon();
  }
  void engage() {
    require_open();
    session_->request_engage();
  }
  // Ends it, and throws how it failed if it did.
  void close() {
    if (closed_) return;
    closed_ = true;
    released([&] {
      session_->request_stop();
      session_->join();
    });
    if (session_->end() == LoopEnd::kDeviceFault)
      throw LoopError(fmt::format("{}: {}", device_->info().name, device_->fault_text()));
  }
  bool is_running() const { return !closed_ && !session_->wait_for(0s); }
  std::uint64_t lost() const { return session_->lost(); }
  std::string device() const { return device_->info().name; }
  bool closed() const { return closed_; }
  // None before the end.
  std::optional<std::string> end() const {
    if (is_running()) return std::nullopt;
    return loop_end_text(session_->end());
  }
  // Lists what the system refused: nothing before the first tick.
  std::vector<std::string> refusals() const {
    return session_->grants().value_or(SessionGrants()).refusals;
  }

 private:
  void require_open() const {
    if (closed_) throw py::value_error("the loop is closed; expected one that is open");
  }

  std::unique_ptr<HapticDevice> device_;
  std::optional<Tracker> tracker_;
  std::optional<LoopSession> session_;
  std::atomic<bool> closed_ = false;
  bool abandoned_ = false;
};

}  // namespace

void bind_loop(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(TickRow, number, time, lateness, compute, age, missed, position, orientation,
                       rendered, sent, rendered_torque, sent_torque, guard, reason, object,
                       touching, face, distance, iterations, flags);
  py::class_<Loop>(module, "OpenLoop", made_by_functions())
      .def("read", &Loop::read)
      .def("wait", &Loop::wait)
      .def("stop", &Loop::stop, py::call_guard<Call>())
      .def("close", &Loop::close)
      .def("abandon", &Loop::abandon)
      .def("engage", &Loop::engage)
      .def_property_readonly("running", &Loop::is_running)
      .def_property_readonly("closed", &Loop::closed)
      .def_property_readonly("lost", &Loop::lost)
      .def_property_readonly("device", &Loop::device)
      .def_property_readonly("end", &Loop::end)
      .def_property_readonly("refusals", &Loop::refusals);
  module.def("open_loop", [](const std::string& scene, const std::string& device, double seconds,
                             bool wait, bool realtime, int threads, int cpu) {
    return std::make_unique<Loop>(scene, device, seconds, wait, realtime, threads, cpu);
  });
}

}  // namespace gliss::python
