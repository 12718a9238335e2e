// The only file that knows oneTBB.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "host/engine.h"

namespace gliss {
namespace {

class TbbEngine final : public Engine {
 public:
  explicit TbbEngine(int threads) : arena_(threads > 0 ? threads : tbb::task_arena::automatic) {}
  const char* name() const override { return "tbb"; }
  int threads() const override { return arena_.max_concurrency(); }
  void for_each(std::size_t count, std::size_t grain,
                const std::function<void(std::size_t, std::size_t)>& body) const override {
    const std::size_t pieces = (count + grain - 1) / grain;
    arena_.execute([&] {
      tbb::parallel_for(std::size_t{0}, pieces,
                        [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); });
    });
  }

 private:
  mutable tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Engine> make_tbb_engine(int threads) {
  return std::make_unique<TbbEngine>(threads);
}

}  // namespace gliss
