// Memory that stays in RAM, as a loop's does.
#pragma once

#include <sys/mman.h>
#include <sys/resource.h>

namespace gliss::test {

// Locks what this process has and gets, until the object is destroyed, if that is granted.
class LockedMemory {
 public:
  LockedMemory() : is_granted_(mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {}
  ~LockedMemory() {
    if (is_granted_) munlockall();
  }
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;

  bool is_granted() const { return is_granted_; }

 private:
  bool is_granted_;
};

// Pages that the calling thread had to wait for: from the disk, and of the memory that there is.
struct PageFaults {
  static PageFaults now() {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return {usage.ru_majflt, usage.ru_minflt};
  }
  PageFaults operator-(const PageFaults& before) const {
    return {major - before.major, minor - before.minor};
  }

  long major = 0, minor = 0;
};

}  // namespace gliss::test
