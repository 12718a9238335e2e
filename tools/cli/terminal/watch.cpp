#include "tools/cli/terminal/watch.h"

#include <mutex>
#include <utility>

#include "tools/cli/terminal/interrupt.h"

namespace gliss::tools {
namespace {

constexpr double kPatience = 0.4;  // seconds without a word

std::mutex mutex;  // of all that is drawn
Watch* latest = nullptr;
Stopwatch silence;  // since the program began, or a bar was drawn

}  // namespace

void stop_if_interrupted() {
  if (interrupted()) throw Interrupted();
  const std::lock_guard lock(mutex);
  if (latest != nullptr) latest->draw();
}

Watch::Watch(const ReportOptions& options, std::string label, std::uint64_t total, std::string noun)
    : progress_(std::move(label), total, std::move(noun),
                options.quiet ? ProgressStyle::kSilent : ProgressStyle::kAutomatic),
      total_(total) {
  const std::lock_guard lock(mutex);
  outer_ = std::exchange(latest, this);
}

// Work that ended early says nothing of its own: an error does.
Watch::~Watch() {
  const std::lock_guard lock(mutex);
  latest = outer_;
  if (shown_ && done_ == total_ && std::uncaught_exceptions() == unwinding_) progress_.finish();
}

void Watch::add(std::uint64_t more) {
  stop_if_interrupted();
  const std::lock_guard lock(mutex);
  done_ += more;
  draw();
}

void Watch::reach(std::uint64_t done) {
  stop_if_interrupted();
  const std::lock_guard lock(mutex);
  done_ = done;
  draw();
}

void Watch::draw() {
  shown_ = shown_ || silence.seconds() > kPatience;
  if (!shown_) return;
  progress_.update(done_);
  silence = {};
}

}  // namespace gliss::tools
