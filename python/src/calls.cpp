#include "calls.h"

#include <chrono>

#include "gliss/thread/clock.h"

namespace gliss::python {
namespace {

constexpr Nanoseconds kPause = std::chrono::milliseconds(20);

thread_local int depth = 0;  // calls of this thread that are under way
thread_local Nanoseconds next{};

}  // namespace

Call::Call() {
  if (depth++ == 0) next = monotonic_time() + kPause;
}

Call::~Call() { --depth; }

void poll() {
  if (depth == 0) return;
  const Nanoseconds now = monotonic_time();
  if (now < next) return;
  const py::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() != 0) throw Interrupted{};
  next = monotonic_time() + kPause;
}

py::custom_type_setup made_by_functions() {
  return py::custom_type_setup([](PyHeapTypeObject* heap_type) {
    heap_type->ht_type.tp_new = [](PyTypeObject* type, PyObject*, PyObject*) -> PyObject* {
      return PyErr_Format(PyExc_TypeError, "%s: No constructor defined!", type->tp_name);
    };
  });
}

void Progress::reach(std::uint64_t done, std::uint64_t total) const {
  if (call_.is_none()) return;
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  std::int64_t next = next_;
  if (done < total &&
      (now.count() < next ||
       !next_.compare_exchange_strong(next, (now + std::chrono::milliseconds(200)).count())))
    return;
  const py::gil_scoped_acquire held;
  call_(done, total);
}

}  // namespace gliss::python
