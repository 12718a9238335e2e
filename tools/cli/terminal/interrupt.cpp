#include "tools/cli/terminal/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

namespace gliss::tools {
namespace {

std::atomic<int> count{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers may take no lock");

// The alarm that a second signal sets is the third.
void handle(int) {
  const int before = count.fetch_add(1);
  if (before == 1) alarm(kLastSeconds);
  if (before >= 2) _exit(kExitInterrupted);
}

void set(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // reads and writes under way just go on
  sigaction(signal, &action, nullptr);
}

}  // namespace

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU}) {
    struct sigaction old {};
    sigaction(signal, nullptr, &old);
    // Ignored by whoever started us (nohup, a background job): that stays.
    if (old.sa_handler != SIG_IGN) set(signal, handle);
  }
  set(SIGALRM, handle);
  set(SIGPIPE, SIG_IGN);
  set(SIGXFSZ, SIG_IGN);
}

bool interrupted() noexcept { return count.load(std::memory_order_relaxed) > 0; }

}  // namespace gliss::tools
