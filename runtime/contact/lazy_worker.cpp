#include "gliss/contact/lazy_worker.h"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>

#include <algorithm>
#include <optional>

#include "gliss/base/plain_arithmetic.h"
#include "gliss/query/contact_tracker.h"

namespace gliss {
namespace {

struct Stopped {};

// Tells where a hand is and goes, from where it is seen now and then.
class HandMotion {
 public:
  // The velocity, in units a second.
  Vec3 see(const Vec3& hip, Nanoseconds now) {
    if (!seen_) from_ = seen_ = Sight{hip, now};
    // Over some ticks, so that it does not matter when in a tick this thread looks.
    if (now - seen_->time >= kBaseline) {
      from_ = seen_;
      seen_ = Sight{hip, now};
    }
    const Nanoseconds time = now - from_->time;
    if (time < kBaseline / 2) return Vec3::Zero();
    return (hip - from_->hip) / in_seconds(time);
  }

 private:
  static constexpr Nanoseconds kBaseline = std::chrono::milliseconds(4);
  struct Sight {
    Vec3 hip;
    Nanoseconds time;
  };
  std::optional<Sight> from_, seen_;
};

}  // namespace

LazyWorker::LazyWorker(std::shared_ptr<const LazyMesh> mesh, LazyWorkerOptions options)
    : mesh_(std::move(mesh)), options_(std::move(options)), thread_([this] { work(); }) {}

LazyWorker::~LazyWorker() {
  stop_ = true;
  thread_.join();
}

void LazyWorker::post(const Vec3& hip, bool touching, std::uint32_t face) noexcept {
  if (hip.allFinite()) posted_.store({{hip.x(), hip.y(), hip.z()}, face, touching});
}

const LazyRegion* LazyWorker::take() noexcept {
  if (newest_.load(std::memory_order_relaxed) == nullptr) return nullptr;
  return newest_.exchange(nullptr, std::memory_order_acquire);
}

void LazyWorker::give_back(const LazyRegion* region) noexcept {
  // What is handed out is const only so that a tick leaves it alone.
  auto* owned = const_cast<Owned*>(static_cast<const Owned*>(region));
  owned->returned.store(true, std::memory_order_release);
}

void LazyWorker::work() {
  const PlainArithmetic plain;
  // A real-time thread may have created this one, which must not keep it from its ticks.
  const sched_param ordinary{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &ordinary);
  prctl(PR_SET_TIMERSLACK, 1);
  HandMotion motion;
  std::uint64_t number = 0;
  while (!stop_.load(std::memory_order_relaxed)) {
    const auto posted = posted_.load();
    if (posted && posted->number != number) {
      number = posted->number;
      const Vec3 hip(posted->value.hip);
      const Vec3 velocity = motion.see(hip, monotonic_time());
      try {
        build_for(posted->value, hip, velocity);
      } catch (const Stopped&) {
      } catch (const std::exception&) {
        // The hand goes on with base polygons, and is told so; there may be memory later.
      }
    }
    free_returned();
    std::this_thread::sleep_for(options_.poll);
  }
}

void LazyWorker::build_for(const Posted& posted, const Vec3& hip, const Vec3& velocity) {
  const std::vector<std::uint32_t> faces = faces_ahead(posted, hip, velocity);
  const bool ready = std::all_of(faces.begin(), faces.end(), [&](std::uint32_t face) {
    return last_ != nullptr && mesh_->is_inside(*last_, face);
  });
  if (ready) return;
  if (options_.before_build) options_.before_build();
  hand_over(mesh_->build(faces, [this] {
    if (stop_.load(std::memory_order_relaxed)) throw Stopped{};
  }));
}

// The base polygons' contacts from here to where the hand will be, on the side that it is on. What
// is too far away for its patch to be touched is not among them.
std::vector<std::uint32_t> LazyWorker::faces_ahead(const Posted& posted, const Vec3& hip,
                                                   const Vec3& velocity) const {
  constexpr int kSteps = 8;
  QueryOptions flat;
  flat.method = Method::kFlat;
  flat.settle = 0;
  ContactTracker contact(mesh_->base(), flat);
  std::vector<std::uint32_t> faces;
  const auto add = [&](const Contact& c) {
    if (!c.touching && c.distance > 1.25 * mesh_->reach()) return;
    if (std::find(faces.begin(), faces.end(), c.at.face) == faces.end()) faces.push_back(c.at.face);
  };
  add(posted.touching ? contact.track(hip, {posted.face}) : contact.tick(hip));
  const Vec3 way = velocity * in_seconds(options_.ahead);
  for (int i = 1; i <= kSteps; ++i) add(contact.tick(hip + way * i / kSteps));
  return faces;
}

void LazyWorker::hand_over(LazyRegion region) {
  owned_.push_back(std::unique_ptr<Owned>(new Owned{std::move(region)}));
  last_ = owned_.back().get();
  regions_.fetch_add(1, std::memory_order_relaxed);
  patches_.fetch_add(last_->cache.patch_count(), std::memory_order_relaxed);
  Owned* missed = newest_.exchange(last_, std::memory_order_acq_rel);
  if (missed != nullptr) missed->returned.store(true, std::memory_order_relaxed);
}

void LazyWorker::free_returned() {
  std::erase_if(owned_, [&](const std::unique_ptr<Owned>& region) {
    return region.get() != last_ && region->returned.load(std::memory_order_acquire);
  });
  held_.store(owned_.size(), std::memory_order_relaxed);
}

}  // namespace gliss
