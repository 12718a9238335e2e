// The program gliss, or another, as a process of its own: what it says, how it ends, and signals on
// the way.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "tests/support/scratch_folder.h"

namespace gliss::test {

struct Outcome {
  int code = -1;  // -1: a signal ended it
  std::string out, err;
};

constexpr int kNotStarted = 99;               // exit code
constexpr std::chrono::minutes kPatience(2);  // with what takes a second

// False where it never came.
template <class Condition>
bool await(Condition condition) {
  const auto start = std::chrono::steady_clock::now();
  while (!condition()) {
    if (std::chrono::steady_clock::now() - start > kPatience) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

class Process {
 public:
  // In this folder; `in_child` before the program takes over, which it does not where that is
  // false.
  Process(
      const std::string& folder, const std::string& program, const std::vector<std::string>& words,
      const std::function<bool()>& in_child = [] { return true; }) {
    std::vector<char*> all{const_cast<char*>(program.c_str())};
    for (const std::string& word : words) all.push_back(const_cast<char*>(word.c_str()));
    all.push_back(nullptr);
    const std::string out = said_ / "out", err = said_ / "err";
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGINT, SIG_DFL);
    const auto become = [](const std::string& path, int flags, int descriptor) {
      return dup2(open(path.c_str(), flags, 0600), descriptor) == descriptor;
    };
    if (become("/dev/null", O_RDONLY, 0) && become(out, O_WRONLY | O_CREAT, 1) &&
        become(err, O_WRONLY | O_CREAT, 2) && chdir(folder.c_str()) == 0 && in_child()) {
      execvp(program.c_str(), all.data());
    }
    _exit(kNotStarted);
  }
  ~Process() {
    if (pid_ > 0) kill(SIGKILL), waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t id() const { return pid_; }
  // Nothing where it is over.
  void kill(int number) const {
    if (pid_ > 0) ::kill(pid_, number);
  }
  // True once it has a handler for this signal.
  bool catches(int number) const {
    const std::string its_program = "/proc/" + std::to_string(pid_) + "/exe";
    std::error_code gone;
    // Until it has begun its own program it has the handlers of the test's.
    if (std::filesystem::equivalent(its_program, "/proc/self/exe", gone) || gone) return false;
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string word; status >> word;) {
      std::uint64_t caught = 0;
      if (word == "SigCgt:" && status >> std::hex >> caught) return (caught >> (number - 1)) & 1;
    }
    return false;
  }
  std::string out() const { return said_.read("out"); }  // so far
  std::string err() const { return said_.read("err"); }

  bool over() {
    if (pid_ > 0 && waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = 0;
    return pid_ == 0;
  }
  Outcome wait() {
    if (!await([&] { return over(); })) ADD_FAILURE() << "it does not end: " << err();
    return {pid_ == 0 && WIFEXITED(status_) ? WEXITSTATUS(status_) : -1, out(), err()};
  }

 private:
  ScratchFolder said_;
  pid_t pid_ = -1;
  int status_ = 0;
};

}  // namespace gliss::test
