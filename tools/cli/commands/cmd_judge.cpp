// gliss judge: whether this machine keeps a loop of 1 kHz. The keys of its JSON are a contract.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <memory>

#include "gliss/engine/engine.h"
#include "gliss/generate/generate.h"
#include "gliss/loop/verdict.h"
#include "gliss/query/contact_tracker.h"
#include "gliss/thread/realtime.h"
#include "tools/cli/commands/commands.h"
#include "tools/cli/terminal/interrupt.h"
#include "tools/cli/terminal/terminal.h"
#include "tools/cli/terminal/watch.h"
#include "tools/cli/words/command.h"
#include "tools/cli/words/timing_text.h"

namespace gliss::tools {
namespace {

constexpr Nanoseconds kPeriod = std::chrono::milliseconds(1);
constexpr std::uint64_t kBlock = 1000;      // periods
constexpr int kAlong = 500, kAround = 20;   // 10,000 patches
constexpr double kDepth = 2, kStep = 0.15;  // mm; the step is that of a tick
constexpr double kStiffness = 500;          // N/m
constexpr char kGoodText[] =
    "wake p99.9 within 50 us of the floor's and 500 us, compute p99 within 50 us, 99.9 % of the "
    "periods succeed";
constexpr char kUsableText[] = "2 ms, 500 us, 99 %";
enum TickError { kFine, kNoContact, kNotConverged };  // of a tick

struct JudgeOptions : ReportOptions {
  double seconds = 30;
  int cpu = -1;
  bool require_realtime = false;
};

void describe(Command& command, JudgeOptions& options) {
  command.option({"--seconds", "SECONDS", "how long to measure, 0.1 to 86400; default 30"},
                 options.seconds, 0.1, 86400);
  add_cpu_option(command, options.cpu);
  command.flag("--require-rt", options.require_realtime,
               "make it an error where real-time scheduling or locked memory is refused");
}

// A tick as a device would have it: the contact and its force for where the hand is now.
class KnotTick {
 public:
  KnotTick()
      : knot_(torus_knot(kAlong, kAround)),
        cache_(make_tbb_engine()->build(knot_.mesh)),
        path_(path_beneath(knot_, kAlong, kAround, kDepth, kStep)),
        tracker_(cache_, {}) {}

  int operator()() noexcept {
    const Contact contact = tracker_.tick(path_[next_]);
    next_ = next_ + 1 < path_.size() ? next_ + 1 : 0;
    if (!(contact_force(cache_, contact, kStiffness).norm() > 0)) return kNoContact;
    return contact.flags & kConverged ? kFine : kNotConverged;
  }

  std::uint32_t patches() const { return cache_.patch_count(); }

 private:
  Generated knot_;
  PatchCache cache_;
  std::vector<Vec3> path_;
  ContactTracker tracker_;
  std::size_t next_ = 0;
};

// Until that many periods are over or somebody interrupts; `done` counts them on.
template <class Tick>
void run_loop(std::uint64_t periods, Tick&& tick, TickRecord& record,
              std::atomic<std::uint64_t>& done) {
  PeriodicTimer timer(kPeriod);
  for (std::uint64_t over = 0; over < periods && !interrupted();) {
    const Wake wake = timer.wait();
    const Nanoseconds start = thread_time();
    const int error = tick();
    record.add({wake.lateness, thread_time() - start, error}, wake.missed);
    over += wake.missed + 1;
    done.fetch_add(wake.missed + 1, std::memory_order_relaxed);
  }
}

struct Judgement {
  TickRecord floor, loop;
  std::string scheduling = "SCHED_OTHER";
  bool memory_locked = false;
  std::vector<std::string> refusals;
};

// In a thread of its own, so that this one may write progress meanwhile.
std::unique_ptr<Judgement> measure(const JudgeOptions& options, KnotTick& tick) {
  auto result = std::make_unique<Judgement>();
  const auto periods = static_cast<std::uint64_t>(options.seconds / 2 * 1e9) /
                       static_cast<std::uint64_t>(kPeriod.count());
  // Turn by turn: what else the machine does comes and goes.
  const auto blocks = std::max<std::uint64_t>(1, periods / kBlock);
  const std::uint64_t total = blocks * (periods / blocks) * 2;
  std::atomic<std::uint64_t> done{0};
  Watch watch(options, "judge", total, "ticks");
  // Leaving this function, by Interrupted too, waits for the thread.
  auto running = std::async(std::launch::async, [&] {
    const Realtime realtime({.require = options.require_realtime, .cpu = options.cpu});
    if (realtime.priority() > 0)
      result->scheduling = fmt::format("SCHED_FIFO {}", realtime.priority());
    result->memory_locked = realtime.memory_locked();
    result->refusals = realtime.refusals();
    for (std::uint64_t block = 0; block < blocks; ++block) {
      run_loop(
          periods / blocks, [] { return kFine; }, result->floor, done);
      run_loop(periods / blocks, tick, result->loop, done);
    }
  });
  while (running.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready) {
    watch.reach(std::min(done.load(std::memory_order_relaxed), total - 1));
  }
  running.get();
  watch.reach(total);
  return result;
}

void run(const JudgeOptions& options) {
  KnotTick tick;
  const auto found = measure(options, tick);
  const TickRecord &floor = found->floor, &loop = found->loop;
  if (!options.quiet) {
    for (const std::string& line : found->refusals) tell(fmt::format("gliss: {}\n", line));
  }
  const std::string verdict = verdict_name(judge(floor, loop));
  const Json json = {{"floor", json_of(floor.lateness())},
                     {"wake", json_of(loop.lateness())},
                     {"compute", json_of(loop.compute())},
                     {"success_rate", loop.success()},
                     {"verdict", verdict},
                     {"seconds", options.seconds},
                     {"scheduling", found->scheduling},
                     {"memory_locked", found->memory_locked},
                     {"refusals", found->refusals},
                     {"patches", tick.patches()},
                     {"ticks", loop.ticks()},
                     {"missed", loop.missed()},
                     {"longest_missed", loop.longest_missed()},
                     {"errors", loop.errors()},
                     {"floor_success_rate", floor.success()}};
  report(options,
         timing_header() + timing_row("floor", floor.lateness()) +
             timing_row("wake", loop.lateness()) + timing_row("compute", loop.compute()) +
             fmt::format(
                 "{} ticks on {} patches, {} missed, at most {} in a row; success {:.3f} %, "
                 "of the empty loop {:.3f} %; {}, memory {}\n"
                 "good: {}; usable: {}\n{}\n",
                 loop.ticks(), tick.patches(), loop.missed(), loop.longest_missed(),
                 100 * loop.success(), 100 * floor.success(), found->scheduling,
                 found->memory_locked ? "locked" : "not locked", kGoodText, kUsableText, verdict),
         json);
}

}  // namespace

void add_judge(Command& program) {
  add_command<JudgeOptions>(
      program, "judge",
      "Judge whether this machine keeps a haptic loop of 1 kHz.\n"
      "floor: lateness of the wakes of an empty loop. wake, compute: of a loop that follows a "
      "contact on 10,000 patches. They take turns of a second.\n"
      "success: the share of the periods that had a tick without an error; missed periods and "
      "ticks that lost the contact have none.\n" +
          fmt::format("good: {}. usable: {}. unfit: less.", kGoodText, kUsableText),
      "gliss judge --seconds 30 --json", describe, run);
}

}  // namespace gliss::tools
