#include "tools/cli/watch.h"

#include <utility>

#include "tools/cli/interrupt.h"

namespace gliss::tools {
namespace {

constexpr double kPatience = 1;  // seconds

}  // namespace

void stop_if_interrupted() {
  if (interrupted()) throw Interrupted();
}

Watch::Watch(const ReportOptions& options, std::string label, std::uint64_t total, std::string noun)
    : progress_(std::move(label), total, std::move(noun),
                options.quiet ? ProgressStyle::kSilent : ProgressStyle::kAutomatic),
      total_(total) {}

// Work that ended early says nothing of its own: an error does.
Watch::~Watch() {
  if (shown_ && done_ == total_) progress_.finish();
}

void Watch::add(std::uint64_t more) {
  const std::lock_guard lock(mutex_);
  reach(done_ + more);
}

void Watch::reach(std::uint64_t done) {
  stop_if_interrupted();
  done_ = done;
  shown_ = shown_ || clock_.seconds() > kPatience;
  if (shown_) progress_.update(done_);
}

}  // namespace gliss::tools
