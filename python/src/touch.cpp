// One HIP that moves: a path of it, or tick by tick.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>

#include "arrays.h"
#include "calls.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/query/trace.h"
#include "gliss/results/trace_json.h"
#include "gliss/tables/point_table.h"
#include "json.h"
#include "options.h"
#include "surface.h"

namespace gliss::python {
namespace {

// The ticks of a path as arrays.
class TickArrays {
 public:
  explicit TickArrays(std::size_t n) : contacts_(n), force_(n, 3), cone_share_(n), slipping_(n) {}

  void set(std::size_t i, const TraceStep& step) {
    contacts_.set(i, step.contact);
    force_.row(i) = step.force;
    cone_share_.data()[i] = step.cone_share;
    slipping_.data()[i] = is_slipping(step.contact.flags);
  }
  py::dict dict() const {
    py::dict out;
    out["force"] = force_.array();
    contacts_.put(out);
    out["slipping"] = slipping_.array();
    out["cone_share"] = cone_share_.array();
    out["flags"] = contacts_.flags();
    return out;
  }

 private:
  NewContacts contacts_;
  NewArray<double> force_, cone_share_;
  NewArray<bool> slipping_;
};

py::object figures_of(const TraceStatistics& statistics) {
  Json json = json_of(statistics);
  json["slipping"] = statistics.slipping;
  return python_of(json);
}

// By way of metres, as the loop has it, so that forces have the bytes of gliss trace.
std::vector<Vec3> hips_of(const Reals& path, double unit) {
  require_points(path, "path");
  PointTable table;
  table.unit = unit;
  table.points.resize(static_cast<std::size_t>(path.shape(0)));
  const StridedVectors<const double> from = vectors(path);
  for (std::size_t i = 0; i < table.points.size(); ++i)
    table.points[i] = Vec3(from.x[i], from.y[i], from.z[i]);
  std::vector<Vec3> hips = points_in_metres(std::move(table));
  for (Vec3& hip : hips) hip /= unit;
  return hips;
}

// Returns the times of a column in s; none if there is no column.
std::vector<std::chrono::nanoseconds> times_of(const std::optional<Reals>& time, std::size_t rows) {
  std::vector<std::chrono::nanoseconds> times;
  if (!time) return times;
  require_rows(*time, "time", 1);
  const Strided<const double> seconds = column(*time, 0);
  const auto n = static_cast<std::size_t>(time->shape(0));
  if (n != rows)
    throw py::value_error(
        fmt::format("time: expected {} numbers, as path has rows, found {}", rows, n));
  for (std::size_t i = 0; i < n; ++i)
    times.emplace_back(std::llround(1e9 * std::clamp(seconds[i], -9e9, 9e9)));
  return times;
}

py::tuple trace(const OpenSurface& surface, const Reals& path, const std::optional<Reals>& time,
                const py::dict& keywords, const py::object& call) {
  const TouchOptions touch = touch_options(keywords);
  TraceOptions options;
  options.methods = {touch.query.method};
  options.stiffness = touch.stiffness;
  options.settle = touch.query.settle;
  options.friction = touch.query.friction;
  options.effects = touch.effects;
  const std::vector<Vec3> hips = hips_of(path, surface.cache->unit);
  const std::vector<std::chrono::nanoseconds> times = times_of(time, hips.size());
  options.times = times;
  options.poll = poll;
  TickArrays ticks(hips.size());
  const Progress progress(call);
  const TraceStatistics statistics = released([&] {
    return gliss::trace(*surface.cache, hips, options,
                        [&](std::size_t tick, std::span<const TraceStep> steps) {
                          ticks.set(tick, steps[0]);
                          poll();
                          progress.reach(tick + 1, hips.size());
                        })
        .front();
  });
  return py::make_tuple(ticks.dict(), figures_of(statistics));
}

// A HIP that keeps its contact from tick to tick. One thread at a time.
class Hand {
 public:
  Hand(std::shared_ptr<const OpenSurface> surface, const TouchOptions& options)
      : surface_(std::move(surface)),
        stiffness_(options.stiffness),
        tracker_(*surface_->cache, options.query) {
    if (options.effects.any()) effects_.emplace(options.effects, stiffness_, surface_->cache->unit);
  }

  // The GIL stays: a tick is shorter than letting it go.
  TraceStep tick(py::handle hip, py::handle seconds) {
    const Vec3 at = point_of(hip, "hip");
    const double dt = python::tick(seconds);
    const Use use(*this);
    return step(at, dt);
  }
  py::dict ticks(const Reals& path, py::handle seconds) {
    require_points(path, "path");
    const double dt = python::tick(seconds);
    const Use use(*this);
    const StridedVectors<const double> from = vectors(path);
    const auto n = static_cast<std::size_t>(path.shape(0));
    TickArrays out(n);
    released([&] {
      for (std::size_t i = 0; i < n; ++i) {
        out.set(i, step(Vec3(from.x[i], from.y[i], from.z[i]), dt));
        poll();
      }
    });
    return out.dict();
  }

 private:
  // The thread that it is made in has the hand until it is destroyed.
  class Use {
   public:
    explicit Use(Hand& hand) : hand_(hand) {
      if (hand_.used_.test_and_set())
        throw std::runtime_error(
            "another thread ticks this hand now; expected one thread at a time, and a hand for "
            "each, by surface.hand()");
    }
    ~Use() { hand_.used_.clear(); }

   private:
    Hand& hand_;
  };
  TraceStep step(const Vec3& hip, double dt) {
    if (effects_) effects_->see(hip, dt);
    TraceStep step;
    step.contact = tracker_.tick(hip, dt);
    step.force = force_of(effects_, step.contact, tracker_, *surface_->cache, stiffness_);
    step.cone_share = tracker_.cone_share();
    return step;
  }

  std::shared_ptr<const OpenSurface> surface_;
  double stiffness_;
  ContactTracker tracker_;
  std::optional<Effects> effects_;
  std::atomic_flag used_ = ATOMIC_FLAG_INIT;
};

std::string text_of(const TraceStep& step) {
  return fmt::format("Contact(touching={}, force=({:g}, {:g}, {:g}), distance={:g}, face={})",
                     step.contact.touching ? "True" : "False", step.force.x(), step.force.y(),
                     step.force.z(), step.contact.distance, step.contact.at.face);
}

}  // namespace

void bind_touch(py::module_& module) {
  const auto contact = [](auto get) {
    return [get](const TraceStep& s) { return get(s.contact); };
  };
  py::class_<TraceStep>(module, "Contact", "What a hand feels at one tick.",
                        py::metaclass(py::handle(reinterpret_cast<PyObject*>(&PyType_Type))),
                        made_by_functions())
      .def_property_readonly(
          "force", [](const TraceStep& s) { return array_of(s.force); },
          "(3,) N, on the hand; zero where it is free.")
      .def_property_readonly("point", contact([](const Contact& c) { return array_of(c.scp); }),
                             "(3,) surface contact point, in the surface's unit.")
      .def_property_readonly("normal", contact([](const Contact& c) { return array_of(c.normal); }),
                             "(3,) outward unit normal there.")
      .def_property_readonly("distance", contact([](const Contact& c) { return c.distance; }),
                             "Signed, in the surface's unit; negative inside.")
      .def_property_readonly("face", contact([](const Contact& c) { return c.at.face; }),
                             "Face of the mesh that the point lies on.")
      .def_property_readonly(
          "domain", contact([](const Contact& c) { return py::make_tuple(c.at.xi, c.at.eta); }),
          "(xi, eta) of the point on its patch.")
      .def_property_readonly("touching", contact([](const Contact& c) { return c.touching; }),
                             "True if the hand is in contact.")
      .def_property_readonly("slipping",
                             contact([](const Contact& c) { return is_slipping(c.flags); }),
                             "True if the contact point slips, with friction.")
      .def_property_readonly(
          "cone_share", [](const TraceStep& s) { return s.cone_share; },
          "The tangential force over what friction at rest permits; 0 without friction.")
      .def_property_readonly("flags", contact([](const Contact& c) { return c.flags; }),
                             "Bits of Gliss's Contact::flags.")
      .def("__repr__", text_of);

  py::class_<Hand>(module, "OpenHand", made_by_functions())
      .def("tick", &Hand::tick)
      .def("ticks", &Hand::ticks);
  module.def("open_hand", [](const std::shared_ptr<OpenSurface>& surface, const py::dict& options) {
    return std::make_unique<Hand>(surface, touch_options(options));
  });
  module.def("trace", trace);
}

}  // namespace gliss::python
