// The batch engine: many patches, points or HIPs at once. One interface; oneTBB behind it here,
// OpenCL later.
#pragma once

#include <memory>
#include <span>

#include "host/patch_cache.h"
#include "host/query.h"

namespace gliss {

class Engine {
 public:
  virtual ~Engine() = default;
  virtual const char* name() const = 0;  // "serial", "tbb"
  virtual int threads() const = 0;
  // Runs body(begin, end) over [0, count) in pieces of `grain`. Pieces are the same on any number
  // of threads, so that results that are merged by piece are too. An exception of the body is
  // thrown again here.
  virtual void for_each(std::size_t count, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)>& body) const = 0;

  PatchCache build(const Mesh& mesh, const BuildOptions& options = {},
                   BuildReport* report = nullptr) const;
  // out.size() == points.size(); every point must be in_domain.
  void evaluate(const PatchCache& cache, std::span<const DomainPoint> points,
                std::span<SurfacePoint> out) const;
  // The global nearest point of each HIP.
  void project(const PatchCache& cache, std::span<const Vec3> hips, const QueryOptions& options,
               std::span<Contact> out) const;
};

std::unique_ptr<Engine> make_serial_engine();
// threads = 0: as many as the machine has.
std::unique_ptr<Engine> make_tbb_engine(int threads = 0);

}  // namespace gliss
