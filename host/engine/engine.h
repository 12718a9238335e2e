// The batch engine: many patches, points or HIPs at once. One interface; oneTBB or OpenCL
// (gliss/engine/opencl.h) behind it.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>

#include "gliss/base/export.h"
#include "gliss/base/poll.h"
#include "gliss/build/build_cache.h"
#include "gliss/query/query.h"

namespace gliss {

// A cache's patches where an engine's kernels reach them. Results and errors are those of query.h,
// whatever the number of threads, and can be asked for from any thread. Cache and engine must
// outlive it.
class GLISS_EXPORT ResidentSurface {
 public:
  virtual ~ResidentSurface() = default;

  // Points: every one must be in_domain.
  virtual void evaluate(const PointArrays<double>& points,
                        const SurfaceArrays<double>& out) const = 0;
  virtual void evaluate(const PointArrays<float>& points,
                        const SurfaceArrays<float>& out) const = 0;
  // The same points on each of the faces: point j of face i at out[i * points + j].
  virtual void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const double> xi,
                             std::span<const double> eta,
                             const SurfaceArrays<double>& out) const = 0;
  virtual void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const float> xi,
                             std::span<const float> eta, const SurfaceArrays<float>& out) const = 0;
  // Global: the nearest contact of each HIP with each method (at most kMethods, each once;
  // options.method is not read), which share the search: HIP i with method m at out[m][i].
  virtual void nearest(const HipArrays<double>& hips, std::span<const Method> methods,
                       const QueryOptions& options,
                       std::span<const ContactArrays<double>> out) const = 0;
  virtual void nearest(const HipArrays<float>& hips, std::span<const Method> methods,
                       const QueryOptions& options,
                       std::span<const ContactArrays<float>> out) const = 0;
  // Local: the contact that each HIP slides to from its start.
  virtual void track(const HipArrays<double>& hips, const PointArrays<double>& starts,
                     const QueryOptions& options, const ContactArrays<double>& out) const = 0;
  virtual void track(const HipArrays<float>& hips, const PointArrays<float>& starts,
                     const QueryOptions& options, const ContactArrays<float>& out) const = 0;

  // The same of structs: out has room for as many as are asked for; nearest's are [method][hip].
  void evaluate(std::span<const DomainPoint> points, std::span<SurfacePoint> out) const {
    require_room(out.size(), points.size());
    evaluate(arrays_of(points), arrays_of(out));
  }
  void nearest(std::span<const Vec3> hips, std::span<const Method> methods,
               const QueryOptions& options, std::span<Contact> out) const {
    require_room(kMethods, methods.size());
    nearest(arrays_of(hips), methods, options, by_method(out, hips.size(), methods.size()));
  }
  void track(std::span<const Vec3> hips, std::span<const DomainPoint> starts,
             const QueryOptions& options, std::span<Contact> out) const {
    require_room(out.size(), hips.size());
    track(arrays_of(hips), arrays_of(starts), options, arrays_of(out));
  }
  // The global nearest point of each HIP, with options.method.
  void project(std::span<const Vec3> hips, const QueryOptions& options,
               std::span<Contact> out) const {
    nearest(hips, {&options.method, 1}, options, out);
  }
};

class GLISS_EXPORT Engine {
 public:
  explicit Engine(Poll poll = {}) : poll_(std::move(poll)) {}
  virtual ~Engine() = default;
  void poll() const { poll_(); }
  virtual const char* name() const = 0;  // "serial", "tbb", "opencl"
  virtual int threads() const = 0;       // of the host
  // HIPs or points that keep it busy at once.
  virtual std::size_t batch() const = 0;
  // Seconds that kernels of a device took since the engine was made; 0 without a device.
  virtual double device_seconds() const { return 0; }
  // Runs body(begin, end) over [0, count) in pieces of `grain`, on the host. Pieces are the same on
  // any number of threads, so that results that are merged by piece are too. An exception of the
  // body is thrown again here.
  virtual void for_each(std::size_t count, std::size_t grain,
                        const std::function<void(std::size_t, std::size_t)>& body) const = 0;

  // Lets build_cache work with this engine, which must outlive it.
  virtual BuildBackend build_backend() const;
  PatchCache build(const Mesh& mesh, const BuildOptions& options = {},
                   BuildReport* report = nullptr) const;
  // Cache and engine must outlive the surface. Throws std::invalid_argument for a cache without
  // patches.
  virtual std::unique_ptr<ResidentSurface> reside(const PatchCache& cache) const;
  std::unique_ptr<ResidentSurface> reside(const PatchCache&&) const = delete;

 private:
  Poll poll_;
};

GLISS_EXPORT std::unique_ptr<Engine> make_serial_engine(Poll poll = {});
// threads = 0: as many as the machine has.
GLISS_EXPORT std::unique_ptr<Engine> make_tbb_engine(int threads = 0, Poll poll = {});

// Returns the name of the instruction set that the library computes with: "baseline", "v3" or "v4".
// Throws std::invalid_argument where the environment variable GLISS_ISA names none of them.
GLISS_EXPORT const char* instruction_set();

}  // namespace gliss
