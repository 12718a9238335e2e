#include "gliss/thread/realtime.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>

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

// True if a limit keeps this process from locking more than so many bytes: it may try.
bool is_bounded_by(rlim_t limit) {
  if (limit == RLIM_INFINITY) return false;
  void* more =
      mmap(nullptr, limit + 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_LOCKED, -1, 0);
  if (more == MAP_FAILED) return true;
  munmap(more, limit + 4096);
  return false;
}

// Returns an error number.
int set_scheduling(pthread_t thread, int policy, int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(thread, policy, &parameters);
}

// Pages that the loop will reach are there before it runs: as many as `left`, above `end`.
[[gnu::noinline]] void touch_stack(const char* end, std::size_t left) {
  constexpr std::size_t kPage = 4096, kPiece = 4 * kPage;
  volatile char stack[kPiece];
  for (std::size_t i = 0; i < kPiece; i += kPage) stack[i] = 0;
  const char* here = const_cast<const char*>(stack);
  if (left > kPiece && here > end && static_cast<std::size_t>(here - end) > 2 * kPiece)
    touch_stack(end, left - kPiece);
  stack[0] = 0;  // after the call, so that it is no jump
}

// The lowest address of the calling thread's stack; null: unknown.
const char* stack_end() {
  pthread_attr_t attributes;
  void* lowest = nullptr;
  std::size_t size = 0;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return nullptr;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  return static_cast<const char*>(lowest);
}

// The objects of this process that have locked its memory.
std::mutex lock_mutex;
int locks = 0;

}  // namespace

std::string set_realtime(pthread_t thread, int priority) {
  const int error = set_scheduling(thread, SCHED_FIFO, priority);
  if (error == 0) return "";
  return detail::message("SCHED_FIFO ", priority, " is refused (", std::strerror(error),
                         "), wakes will be late under load: ulimit -r (RLIMIT_RTPRIO) is ",
                         limit_text(limit_of(RLIMIT_RTPRIO)), "; cure: 'USER - rtprio ", priority,
                         "' in ", kLimitsFile, ", or give the program CAP_SYS_NICE");
}

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
  touch_stack(stack_end(), kStackBytes);
  lock_memory();
  schedule(options.priority);
  if (options.cpu >= 0) pin(options.cpu);
  // Held as long as the file is open: no wake takes longer than so many microseconds.
  awake_ = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  const std::int32_t latency = 0;
  if (awake_ >= 0 && write(awake_, &latency, sizeof latency) != sizeof latency) {
    close(awake_);
    awake_ = -1;
  }
  if (!options.require || refusals_.empty()) return;
  restore();
  std::string all;
  for (const std::string& line : refusals_) all += (all.empty() ? "" : "; ") + line;
  throw LoopError(all);
}

Realtime::~Realtime() { restore(); }

void Realtime::schedule(int wanted) {
  const std::string refused = set_realtime(pthread_self(), wanted);
  if (refused.empty())
    priority_ = wanted;
  else
    refusals_.push_back(refused);
}

void Realtime::pin(int cpu) {
  pthread_getaffinity_np(pthread_self(), sizeof old_cpus_, &old_cpus_);
  cpu_set_t one;
  CPU_ZERO(&one);
  if (cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &one);
  const int error = pthread_setaffinity_np(pthread_self(), sizeof one, &one);
  pinned_ = error == 0;
  if (pinned_) return;
  std::string permitted;
  for (std::size_t i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(i, &old_cpus_)) permitted += (permitted.empty() ? "" : ",") + std::to_string(i);
  }
  refusals_.push_back(detail::message("processor ", cpu, " is refused (", std::strerror(error),
                                      "), the thread may run on ", permitted));
}

// Memory that comes later is not locked where a limit would refuse it then: an allocation that
// fails is worse than one that is swapped out.
void Realtime::lock_memory() {
  const std::lock_guard guard(lock_mutex);
  const rlim_t limit = limit_of(RLIMIT_MEMLOCK);  // bytes; ulimit says KiB
  const bool is_bounded = is_bounded_by(limit);
  memory_locked_ = mlockall(is_bounded ? MCL_CURRENT : MCL_CURRENT | MCL_FUTURE) == 0;
  locks += memory_locked_;
  if (memory_locked_ && !is_bounded) return;
  const std::string what =
      memory_locked_ ? "locking memory that comes later is left out"
                     : detail::message("locking memory is refused (", std::strerror(errno), ")");
  refusals_.push_back(detail::message(
      what, ", it may be swapped out: ulimit -l (RLIMIT_MEMLOCK) is ",
      limit_text(limit == RLIM_INFINITY ? limit : limit / 1024),
      "; cure: 'USER - memlock unlimited' in ", kLimitsFile, ", or give the program CAP_IPC_LOCK"));
}

// Without CAP_SYS_NICE lowering is permitted too; what cannot be undone stays.
void Realtime::restore() noexcept {
  if (priority_ > 0) set_scheduling(pthread_self(), old_policy_, old_priority_);
  if (old_slack_ > 0) prctl(PR_SET_TIMERSLACK, old_slack_);
  if (pinned_) pthread_setaffinity_np(pthread_self(), sizeof old_cpus_, &old_cpus_);
  if (awake_ >= 0) close(awake_);
  if (!memory_locked_) return;
  const std::lock_guard guard(lock_mutex);
  if (--locks == 0) munlockall();
}

}  // namespace gliss
