// Long work that asks now and then whether to go on.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>

namespace gliss {

// Called for each item of work, asks once in a thousand. What `ask` throws ends the work.
class Poll {
 public:
  explicit Poll(std::function<void()> ask) : ask_(std::move(ask)) {}

  void operator()() {
    if (++items_ % 1024 == 0 && ask_) ask_();
  }

 private:
  std::function<void()> ask_;
  std::size_t items_ = 0;
};

}  // namespace gliss
