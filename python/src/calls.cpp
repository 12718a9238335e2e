#include "calls.h"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "gliss/thread/clock.h"

namespace gliss::python {
namespace {

constexpr Nanoseconds kPause = std::chrono::milliseconds(20);

thread_local int depth = 0;  // calls of this thread that are under way
thread_local Nanoseconds next{};

// Once in a thread.
void require_stack() {
  constexpr std::size_t kLeast = 384 << 10;
  thread_local bool is_checked = false;
  if (std::exchange(is_checked, true)) return;
  pthread_attr_t attributes;
  std::size_t size = kLeast;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  pthread_attr_getstacksize(&attributes, &size);
  pthread_attr_destroy(&attributes);
  is_checked = size >= kLeast;
  if (!is_checked)
    throw std::runtime_error(
        "this thread's stack is below 384 KiB; cure: threading.stack_size(1 << 20) before it "
        "starts");
}

// The thread that ends the interpreter, once it does, and threads on their way to the GIL.
std::atomic<std::thread::id> ending{};
std::atomic<int> arriving{0};

// To be called before the GIL is taken, and arrived() after.
void arrive() {
  ++arriving;
  const std::thread::id ends = ending;
  if (ends == std::thread::id{} || ends == std::this_thread::get_id()) return;
  --arriving;
  for (;;) pause();
}
void arrived() { --arriving; }

void end_of_interpreter() {
  ending = std::this_thread::get_id();
  const py::gil_scoped_release released;
  while (arriving != 0) std::this_thread::yield();
}

}  // namespace

void keep_calls_whole() {
  py::module_::import("atexit").attr("register")(py::cpp_function(end_of_interpreter));
  pthread_atfork(nullptr, nullptr, [] { arriving = 0; });  // the child has none of these threads
}

Acquired::Acquired() : state_((arrive(), PyGILState_Ensure())) { arrived(); }

Acquired::~Acquired() { PyGILState_Release(state_); }

Call::Call() : state_((require_stack(), PyEval_SaveThread())) {
  if (depth++ == 0) next = monotonic_time() + kPause;
}

Call::~Call() {
  --depth;
  arrive();
  PyEval_RestoreThread(state_);
  arrived();
}

void poll() {
  if (depth == 0) return;
  const Nanoseconds now = monotonic_time();
  if (now < next) return;
  const Acquired acquired;
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
  const Acquired held;
  call_(done, total);
}

}  // namespace gliss::python
