// The only file that knows oneTBB.
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/engine/engine.h"

namespace gliss {
namespace {

// Makes what is written before give() visible to who comes after take(). oneTBB sees to that
// itself; but where its library is not instrumented, ThreadSanitizer has to be told.
struct Handover {
#ifdef __SANITIZE_THREAD__
  void give() { gifts.fetch_add(1, std::memory_order_release); }
  void take() { gifts.load(std::memory_order_acquire); }
  std::atomic<int> gifts{0};
#else
  void give() {}
  void take() {}
#endif
};
Handover work, results;  // of all loops: to find one of its own would be a read before take()

class TbbEngine final : public Engine {
 public:
  TbbEngine(int threads, Poll poll)
      : Engine(std::move(poll)),
        threads_(threads > 0 ? threads : tbb::info::default_concurrency()),
        arena_(threads_ + kCallers - 1, kCallers) {
    // More threads than cores are allowed when they are asked for.
    if (threads > 0) {
      limit_.emplace(tbb::global_control::max_allowed_parallelism,
                     std::max<std::size_t>(static_cast<std::size_t>(threads),
                                           tbb::global_control::active_value(
                                               tbb::global_control::max_allowed_parallelism)));
    }
  }
  const char* name() const override { return "tbb"; }
  int threads() const override { return threads_; }
  std::size_t batch() const override { return 16384 * static_cast<std::size_t>(threads()); }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    const std::size_t pieces = (count + grain - 1) / grain;
    const auto do_piece = [&](std::size_t i) {
      work.take();
      const PlainArithmetic plain;
      poll();
      body(i * grain, std::min(count, (i + 1) * grain));
      results.give();
    };
    const auto do_all = [&] {
      work.take();
      tbb::parallel_for(std::size_t{0}, pieces, do_piece);
    };
    work.give();
    arena_.execute(do_all);
    results.take();
  }

 private:
  // Loops that may be under way at once, such as a sweep's two. With a place for one alone, the
  // thread that helps would leave it to the second caller, and not be called back after.
  static constexpr int kCallers = 2;

  const int threads_;
  std::optional<tbb::global_control> limit_;
  mutable tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Engine> make_tbb_engine(int threads, Poll poll) {
  return std::make_unique<TbbEngine>(threads, std::move(poll));
}

}  // namespace gliss
