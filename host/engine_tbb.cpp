// The only file that knows oneTBB.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

#include "host/engine.h"

namespace gliss {
namespace {

class TbbEngine final : public Engine {
 public:
  explicit TbbEngine(int threads) : arena_(threads > 0 ? threads : tbb::task_arena::automatic) {
    // More threads than cores are allowed when they are asked for.
    if (threads > 0) {
      limit_.emplace(tbb::global_control::max_allowed_parallelism,
                     std::max<std::size_t>(static_cast<std::size_t>(threads),
                                           tbb::global_control::active_value(
                                               tbb::global_control::max_allowed_parallelism)));
    }
  }
  const char* name() const override { return "tbb"; }
  int threads() const override { return arena_.max_concurrency(); }
  std::size_t batch() const override { return 16384 * static_cast<std::size_t>(threads()); }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    const std::size_t pieces = (count + grain - 1) / grain;
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, pieces,
                        [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); });
    });
  }

 private:
  std::optional<tbb::global_control> limit_;
  mutable tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Engine> make_tbb_engine(int threads) {
  return std::make_unique<TbbEngine>(threads);
}

}  // namespace gliss
