// A child process that may do nothing in real time, whoever runs the tests.
#pragma once

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gliss::test {

// Lowers the limits as ulimit -r 0 -l 64 does, or to so many bytes of memory, without the
// capabilities that go beyond limits, here and in what is executed. For a child: there is no way
// back. False where it cannot be done.
inline bool limit_realtime(rlim_t bytes = 64 << 10) {
  const rlimit priority{0, 0}, memory{bytes, bytes};
  bool done = setrlimit(RLIMIT_RTPRIO, &priority) == 0 && setrlimit(RLIMIT_MEMLOCK, &memory) == 0;
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[2]{};
  done = done && syscall(SYS_capget, &header, sets) == 0;
  for (const int capability : {CAP_SYS_NICE, CAP_IPC_LOCK}) {
    const unsigned bit = 1u << capability;
    const bool had = (sets[0].permitted & bit) != 0;
    // Root would get it back from the bounding set.
    done = done && (prctl(PR_CAPBSET_DROP, capability) == 0 || !had);
    sets[0].effective &= ~bit;
    sets[0].permitted &= ~bit;
    sets[0].inheritable &= ~bit;
  }
  return done && syscall(SYS_capset, &header, sets) == 0;
}

}  // namespace gliss::test
