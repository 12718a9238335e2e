// How the threads of a process are scheduled, as the system has it.
#pragma once

#include <sched.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace gliss::test {

// SCHED_FIFO's of the threads that have one. A thread, or process, that ends meanwhile has none.
inline std::vector<int> fifo_priorities(pid_t process) {
  std::vector<int> all;
  std::error_code gone;
  const std::string tasks = "/proc/" + std::to_string(process) + "/task";
  for (std::filesystem::directory_iterator task(tasks, gone), end; !gone && task != end;
       task.increment(gone)) {
    const int thread = std::stoi(task->path().filename().string());
    sched_param parameters{};
    if (sched_getscheduler(thread) == SCHED_FIFO && sched_getparam(thread, &parameters) == 0)
      all.push_back(parameters.sched_priority);
  }
  return all;
}

}  // namespace gliss::test
