#include "gliss/scene/session.h"

#include <boost/lockfree/spsc_queue.hpp>
#include <thread>

namespace gliss {

using namespace std::chrono_literals;

struct LoopSession::Ring : boost::lockfree::spsc_queue<LoopTick> {
  using boost::lockfree::spsc_queue<LoopTick>::spsc_queue;
};

LoopSession::LoopSession(HapticDevice& device, Tracker& tracker, const LoopOptions& rules,
                         const SessionOptions& options)
    : loop_(device, tracker, rules), ring_(std::make_unique<Ring>(options.ring)) {
  running_ =
      std::async(std::launch::async, [this, &device, &tracker, keeps_clock = rules.wait, options] {
        run(device, tracker, keeps_clock, options);
      }).share();
}

LoopSession::~LoopSession() {
  request_stop();
  wait();
}

void LoopSession::take(std::vector<LoopTick>& ticks) {
  ticks.clear();
  ring_->consume_all([&](const LoopTick& tick) { ticks.push_back(tick); });
}

std::optional<SessionGrants> LoopSession::grants() const {
  if (!is_ready_) return std::nullopt;
  return grants_;
}

// Whoever forgets this future waits for a thread that is not there: it is kept.
void LoopSession::abandon() { new std::shared_future<void>(std::move(running_)); }

void LoopSession::run(HapticDevice& device, Tracker& tracker, bool keeps_clock,
                      const SessionOptions& options) {
  std::optional<Realtime> realtime;
  if (keeps_clock && options.realtime) {
    realtime.emplace(options.scheduling);
    grants_ = {realtime->priority(), realtime->memory_locked(), realtime->refusals()};
    for (const std::string& line : device.refusals()) {
      if (options.scheduling.require) throw LoopError(line);
      grants_.refusals.push_back(line);
    }
  }
  is_ready_ = true;
  end_ = loop_.run([&](const LoopTick& tick) {
    while (!ring_->push(tick)) {
      if (keeps_clock || loop_.stop_requested()) {
        lost_.fetch_add(1, std::memory_order_relaxed);
        break;
      }
      std::this_thread::sleep_for(100us);
    }
    if (options.after_tick) options.after_tick(tracker);
    return !(options.seconds > 0 && in_seconds(tick.time) >= options.seconds);
  });
}

}  // namespace gliss
