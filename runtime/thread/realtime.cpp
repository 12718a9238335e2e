#include "gliss/thread/realtime.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>

#include "gliss/base/message.h"

namespace gliss {
namespace {

constexpr char kLimitsFile[] = "/etc/security/limits.d/gliss.conf, then log in again";

rlim_t limit_of(__rlimit_resource resource) {
  rlimit limit{};
  getrlimit(resource, &limit);
  return limit.rlim_cur;
}

std::string limit_text(rlim_t limit) {
  return limit == RLIM_INFINITY ? "unlimited" : std::to_string(limit);
}

// Returns an error number.
int set_scheduling(int policy, int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), policy, &parameters);
}

// Pages that the loop will reach are there before it runs.
[[gnu::noinline]] void touch_stack() {
  volatile char stack[Realtime::kStackBytes];
  constexpr std::size_t kPage = 4096;
  for (std::size_t i = 0; i < sizeof stack; i += kPage) stack[i] = 0;
}

}  // namespace

Realtime::Realtime(const RealtimeOptions& options) {
  if (options.priority < 1 || options.priority > 99)
    throw std::invalid_argument("a real-time priority must be 1 to 99");
  sched_param old{};
  pthread_getschedparam(pthread_self(), &old_policy_, &old);
  old_priority_ = old.sched_priority;
  old_slack_ = prctl(PR_GET_TIMERSLACK);
  // Before SCHED_FIFO, which needs none and, on new kernels, takes none.
  prctl(PR_SET_TIMERSLACK, 1);
  // Before the lock, under which a stack that outgrows RLIMIT_MEMLOCK is SIGSEGV.
  touch_stack();
  lock_memory();
  schedule(options.priority);
  if (!options.require || refusals_.empty()) return;
  restore();
  std::string all;
  for (const std::string& line : refusals_) all += (all.empty() ? "" : "; ") + line;
  throw LoopError(all);
}

Realtime::~Realtime() { restore(); }

void Realtime::schedule(int wanted) {
  const int error = set_scheduling(SCHED_FIFO, wanted);
  if (error == 0) {
    priority_ = wanted;
    return;
  }
  refusals_.push_back(
      detail::message("SCHED_FIFO ", wanted, " is refused (", std::strerror(error),
                      "), wakes will be late under load: ulimit -r (RLIMIT_RTPRIO) is ",
                      limit_text(limit_of(RLIMIT_RTPRIO)), "; cure: 'USER - rtprio ", wanted,
                      "' in ", kLimitsFile, ", or give the program CAP_SYS_NICE"));
}

void Realtime::lock_memory() {
  memory_locked_ = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (memory_locked_) return;
  const int error = errno;
  const rlim_t limit = limit_of(RLIMIT_MEMLOCK);  // bytes; ulimit says KiB
  refusals_.push_back(detail::message("locking memory is refused (", std::strerror(error),
                                      "), it may be swapped out: ulimit -l (RLIMIT_MEMLOCK) is ",
                                      limit_text(limit == RLIM_INFINITY ? limit : limit / 1024),
                                      "; cure: 'USER - memlock unlimited' in ", kLimitsFile,
                                      ", or give the program CAP_IPC_LOCK"));
}

// Without CAP_SYS_NICE lowering is permitted too; what cannot be undone stays.
void Realtime::restore() noexcept {
  if (priority_ > 0) set_scheduling(old_policy_, old_priority_);
  if (old_slack_ > 0) prctl(PR_SET_TIMERSLACK, old_slack_);
  if (memory_locked_) munlockall();
}

}  // namespace gliss
