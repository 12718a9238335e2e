// The thread that builds patches ahead of a hand, and what it and a tick hand each other. Neither
// waits for the other.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "gliss/base/export.h"
#include "gliss/lazy/lazy_mesh.h"
#include "gliss/query/query.h"
#include "gliss/thread/clock.h"
#include "gliss/thread/seqlock.h"

namespace gliss {

struct LazyWorkerOptions {
  Nanoseconds ahead = std::chrono::milliseconds(20);  // patches are there so long before the hand
  Nanoseconds poll = std::chrono::microseconds(500);
  // For tests: called by the worker before each region that it builds.
  std::function<void()> before_build = nullptr;
};

class GLISS_EXPORT LazyWorker {
 public:
  explicit LazyWorker(std::shared_ptr<const LazyMesh> mesh, LazyWorkerOptions options = {});
  ~LazyWorker();  // ends a region that is being built
  LazyWorker(const LazyWorker&) = delete;
  LazyWorker& operator=(const LazyWorker&) = delete;

  // For the tick's thread; a few stores or loads each.
  // Tells the worker where the HIP is (mesh's unit), and the face of the last contact or nearest
  // point.
  void post(const Vec3& hip, bool touching, std::uint32_t face) noexcept;
  // The newest region that was not taken before, or null. It stays until it is given back.
  const LazyRegion* take() noexcept;
  void give_back(const LazyRegion* region) noexcept;

  std::uint64_t regions() const {
    return regions_.load(std::memory_order_relaxed);
  }  // built so far
  std::uint64_t patches() const { return patches_.load(std::memory_order_relaxed); }
  std::size_t held() const { return held_.load(std::memory_order_relaxed); }  // not freed yet

 private:
  struct Posted {  // Eigen's vectors are not trivially copyable
    double hip[3];
    std::uint32_t face, touching;
  };
  struct Owned : LazyRegion {
    std::atomic<bool> returned{false};
  };

  void work();
  void build_for(const Posted& posted, const Vec3& hip, const Vec3& velocity);
  std::vector<std::uint32_t> faces_ahead(const Posted& posted, const Vec3& hip,
                                         const Vec3& velocity) const;
  void hand_over(LazyRegion region);
  void free_returned();

  const std::shared_ptr<const LazyMesh> mesh_;
  const LazyWorkerOptions options_;
  Seqlock<Posted> posted_;
  std::atomic<Owned*> newest_{nullptr};        // in the worker's hands again where it is taken back
  std::vector<std::unique_ptr<Owned>> owned_;  // by the worker alone: all that live
  Owned* last_ = nullptr;                      // the last one handed over, which is kept
  std::atomic<std::uint64_t> regions_{0}, patches_{0};
  std::atomic<std::size_t> held_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace gliss
