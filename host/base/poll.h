// How long work is stopped: it asks now and then whether to go on.
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <utility>

namespace gliss {

// A question that long work asks many times a second, from any of its threads. What the function
// throws ends the work, and whoever asked for the work gets it; without one nothing ends it.
class Poll {
 public:
  Poll(std::nullptr_t = nullptr) {}
  template <std::invocable Ask>
  requires(!std::same_as<Ask, Poll>) Poll(Ask ask) : ask_(std::move(ask)) {}

  // True if there is a function.
  explicit operator bool() const { return static_cast<bool>(ask_); }
  void operator()() const {
    if (ask_) ask_();
  }

 private:
  std::function<void()> ask_;
};

// Called for each item of work, asks once in a thousand.
class ItemPoll {
 public:
  explicit ItemPoll(Poll poll) : poll_(std::move(poll)) {}

  void operator()() {
    if (++items_ % 1024 == 0) poll_();
  }

 private:
  Poll poll_;
  std::size_t items_ = 0;
};

}  // namespace gliss
