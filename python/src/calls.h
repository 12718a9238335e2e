// Long calls from Python: other threads of it run meanwhile, and Ctrl-C ends them.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <cstdint>
#include <utility>

namespace gliss::python {

namespace py = pybind11;

// Ends work after a signal whose handler has raised a Python error, which is set then.
struct Interrupted {};

// For a class whose objects functions make: those of Class.__new__(Class) would never have been
// set.
py::custom_type_setup made_by_functions();

// Looks for signals every 20 ms, in a thread that is within released(); elsewhere it does nothing.
// Throws Interrupted. For whatever asks now and then, from any thread, without the GIL.
void poll();

// Keeps threads that are at work when the interpreter ends, which daemon threads may be, from the
// GIL: there they would be ended within functions that may not throw, and the process with them.
void keep_calls_whole();

// Holds the GIL, for a thread that works within released(); in such a thread at the end of the
// interpreter it never returns.
class Acquired {
 public:
  Acquired();
  ~Acquired();
  Acquired(const Acquired&) = delete;
  Acquired& operator=(const Acquired&) = delete;

 private:
  const PyGILState_STATE state_;
};

// A thread's work within released(). Throws std::runtime_error on a stack too small for it.
class Call {
 public:
  Call();
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  PyThreadState* const state_;
};

// Calls a Python function (done, total) at most five times a second, and at the end; None: nothing.
// For any thread within released(). What the function raises ends the work.
class Progress {
 public:
  explicit Progress(py::object call) : call_(std::move(call)) {}
  void reach(std::uint64_t done, std::uint64_t total) const;

 private:
  py::object call_;
  mutable std::atomic<std::int64_t> next_ = 0;  // ns, by the steady clock
};

// Does the work without the GIL, and returns what it returns. Throws what it throws, and the Python
// error of a signal.
template <class Work>
auto released(Work work) {
  try {
    const Call call;
    return work();
  } catch (const Interrupted&) {
    throw py::error_already_set();
  }
}

}  // namespace gliss::python
