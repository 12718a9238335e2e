// Queries on an OpenCL device. The host places points and HIPs in the frames of the kernels and
// takes results back, in pieces on all cores; two queues take turns, so that one's transfers and
// host work overlap the other's kernels.
#include <algorithm>
#include <array>
#include <optional>

#include "gliss/engine/opencl_arrays.h"
#include "gliss/engine/opencl_queue.h"
#include "gliss/engine/opencl_shared.h"
#include "gliss/query/frames.h"
#include "gliss/query/point_blocks.h"

namespace gliss {
namespace {

constexpr std::size_t kPointGrain = 4096, kHipGrain = 1024;
// At once on a processor: fewer and they wait for each other more, more and they leave its caches.
constexpr std::size_t kPoints = 1 << 18, kHips = 1 << 16;

template <class Real>
class OpenClSurface final : public ResidentSurface {
 public:
  OpenClSurface(const OpenClShared& shared, const PatchCache& cache, const Surface<Real>& s)
      : shared_(shared),
        cache_(cache),
        surface_(s),
        host_(shared.host->reside(cache)),
        lanes_(static_cast<std::size_t>(shared.lanes(kPrecision<Real>))),
        there_(shared.device, s),
        turns_{Turn(shared), Turn(shared)} {}

  void evaluate(std::span<const DomainPoint> points, std::span<SurfacePoint> out) const override {
    require_room(out.size(), points.size());
    on_device(
        points.size(), kPoints, 11 * sizeof(Real) * lanes_,
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          start_evaluate(turn, points.subspan(begin, count));
        },
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          finish_evaluate(turn, out.subspan(begin, count));
        },
        [&] { host_->evaluate(points, out); });
  }

  void nearest(std::span<const Vec3> hips, std::span<const Method> methods,
               const QueryOptions& options, std::span<Contact> out) const override {
    require_room(kMethods, methods.size());
    require_room(out.size(), methods.size() * hips.size());
    cl_uint packed = 0;
    for (std::size_t m = 0; m < methods.size(); ++m)
      packed |= static_cast<cl_uint>(methods[m]) << 4 * m;
    const TrackOptions<Real> track = track_options<Real>(options);
    on_device(
        hips.size(), kHips, hip_bytes(methods.size()),
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          start_hips(turn, hips.subspan(begin, count), methods.size());
          turn.ran(kernel(nearest_)(
              turn.queue, count, turn.in.buffer(), packed, static_cast<cl_uint>(methods.size()),
              static_cast<cl_int>(track.solver), static_cast<cl_int>(track.max_iterations),
              track.tolerance, static_cast<cl_int>(track.budget), turn.out.buffer(),
              turn.out_index.buffer()));
          turn.out.download();
          turn.out_index.download();
        },
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          for (std::size_t m = 0; m < methods.size(); ++m)
            finish_contacts(turn, m * count, row_stride(methods.size() * count),
                            out.subspan(m * hips.size() + begin, count));
        },
        [&] { host_->nearest(hips, methods, options, out); });
  }

  void track(std::span<const Vec3> hips, std::span<const DomainPoint> starts,
             const QueryOptions& options, std::span<Contact> out) const override {
    require_room(starts.size(), hips.size());
    require_room(out.size(), hips.size());
    const TrackOptions<Real> track = track_options<Real>(options);
    on_device(
        hips.size(), kHips, hip_bytes(1) + 2 * sizeof(Real) + sizeof(cl_uint),
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          start_hips(turn, hips.subspan(begin, count), 1);
          turn.start.resize(2 * count);
          turn.in_index.resize(count);
          Real* start = turn.start.data();
          cl_uint* patch = turn.in_index.data();
          for_pieces(count, [&](std::size_t i) {
            const PatchPlace place = place_of(cache_, surface_, starts[begin + i]);
            patch[i] = place.patch;
            start[i] = static_cast<Real>(place.xi);
            start[count + i] = static_cast<Real>(place.eta);
          });
          turn.start.upload();
          turn.in_index.upload();
          turn.ran(kernel(track_)(
              turn.queue, count, turn.in.buffer(), turn.in_index.buffer(), turn.start.buffer(),
              static_cast<cl_int>(options.method), static_cast<cl_int>(track.solver),
              static_cast<cl_int>(track.max_iterations), track.tolerance,
              static_cast<cl_int>(track.budget), turn.out.buffer(), turn.out_index.buffer()));
          turn.out.download();
          turn.out_index.download();
        },
        [&](Turn& turn, std::size_t begin, std::size_t count) {
          finish_contacts(turn, 0, row_stride(count), out.subspan(begin, count));
        },
        [&] { host_->track(hips, starts, options, out); });
  }

 private:
  // One of the two queues with its arrays.
  struct Turn {
    const OpenClShared& shared;
    cl::CommandQueue queue;
    Staging<Real> in, start, out;
    Staging<cl_uint> in_index, out_index;
    std::vector<PointBlocks<Real>> blocks;  // of pieces of points
    std::vector<cl::Event> kernels;         // not yet timed
    std::size_t begin = 0, count = 0;       // of what is under way

    explicit Turn(const OpenClShared& s)
        : shared(s),
          queue(s.device.context(), s.device.id(), CL_QUEUE_PROFILING_ENABLE),
          in(s.device, queue, "the input"),
          start(s.device, queue, "the input"),
          out(s.device, queue, "the results"),
          in_index(s.device, queue, "the input"),
          out_index(s.device, queue, "the results") {}

    void ran(cl::Event event) { kernels.push_back(std::move(event)); }
    void wait() {
      queue.finish();
      shared.count(kernels);
    }
  };

  // A kernel of this surface, compiled when it is first needed.
  struct Kernel {
    const char *program, *name;
    int lanes;
    std::optional<Launch> launch;
  };
  Launch& kernel(Kernel& k) const {
    if (!k.launch) k.launch.emplace(there_.launch(shared_.device, k.program, k.name, k.lanes));
    return *k.launch;
  }

  static std::size_t hip_bytes(std::size_t methods) {
    return 6 * sizeof(Real) +
           methods * (kContactReals * sizeof(Real) + kContactUints * sizeof(cl_uint));
  }

  // Cuts [0, count) into chunks: enough to keep the device busy, few enough for its memory, and
  // several, so that they overlap.
  std::size_t chunk_of(std::size_t count, std::size_t at_once, std::size_t bytes) const {
    const std::size_t fits = (shared_.device.memory() - there_.bytes) / (2 * bytes);
    if (fits < kGroup) throw shared_.device.error("its memory is full of patches");
    if (!shared_.on_gpu()) return std::min(fits, at_once);
    return std::min(fits, std::clamp<std::size_t>((count + 3) / 4, 1 << 17, 1 << 20));
  }

  template <class Start, class Finish, class OnHost>
  void on_device(std::size_t count, std::size_t at_once, std::size_t bytes, Start start,
                 Finish finish, OnHost on_host) const {
    if (count < shared_.options.smallest_batch) return on_host();
    shared_.run(
        [&] {
          const std::lock_guard lock(mutex_);
          const Idle idle{turns_};
          const std::size_t chunk = chunk_of(count, at_once, bytes);
          const auto settle = [&](Turn& turn) {
            if (turn.count == 0) return;
            turn.wait();
            finish(turn, turn.begin, std::exchange(turn.count, 0));
          };
          for (std::size_t begin = 0, i = 0; begin < count; begin += chunk, ++i) {
            Turn& turn = turns_[i % 2];
            settle(turn);
            turn.begin = begin;
            const std::size_t size = std::min(chunk, count - begin);
            start(turn, begin, size);
            turn.queue.flush();
            turn.count = size;
          }
          const bool second = turns_[0].begin > turns_[1].begin;
          settle(turns_[second]);
          settle(turns_[!second]);
        },
        on_host);
  }

  // Nothing is under way when work ends, however it ends.
  struct Idle {
    std::array<Turn, 2>& turns;
    ~Idle() {
      for (Turn& turn : turns) {
        clFinish(turn.queue());
        turn.kernels.clear();
        turn.count = 0;
      }
    }
  };

  template <class Body>
  void for_pieces(std::size_t count, Body body) const {
    shared_.host->for_each(count, kHipGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  void start_evaluate(Turn& turn, std::span<const DomainPoint> points) const {
    const std::size_t pieces = (points.size() + kPointGrain - 1) / kPointGrain;
    turn.blocks.resize(pieces);
    shared_.host->for_each(points.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      block_points(cache_, surface_, points.subspan(begin, end - begin), lanes_,
                   turn.blocks[begin / kPointGrain]);
    });
    std::vector<std::size_t> first(pieces + 1, 0);  // block of each piece
    for (std::size_t i = 0; i < pieces; ++i) first[i + 1] = first[i] + turn.blocks[i].patch.size();
    const std::size_t count = first.back(), slots = count * lanes_;
    turn.in_index.resize(count);
    turn.in.resize(2 * slots);
    turn.out.resize(9 * row_stride(slots));
    cl_uint* patch = turn.in_index.data();
    Real* in = turn.in.data();
    shared_.host->for_each(pieces, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const PointBlocks<Real>& b = turn.blocks[i];
        std::copy(b.patch.begin(), b.patch.end(), patch + first[i]);
        std::copy(b.xi.begin(), b.xi.end(), in + first[i] * lanes_);
        std::copy(b.eta.begin(), b.eta.end(), in + slots + first[i] * lanes_);
      }
    });
    turn.in_index.upload();
    turn.in.upload();
    turn.ran(kernel(evaluate_)(turn.queue, count, turn.in_index.buffer(), turn.in.buffer(),
                               turn.out.buffer()));
    turn.out.download();
  }

  void finish_evaluate(Turn& turn, std::span<SurfacePoint> out) const {
    std::vector<std::size_t> first(turn.blocks.size() + 1, 0);  // slot of each piece
    for (std::size_t i = 0; i < turn.blocks.size(); ++i)
      first[i + 1] = first[i] + turn.blocks[i].slots();
    const Real* all = turn.out.data();
    shared_.host->for_each(out.size(), kPointGrain, [&](std::size_t begin, std::size_t end) {
      const PointBlocks<Real>& b = turn.blocks[begin / kPointGrain];
      surface_points<Real>(cache_, surface_, b.patch_of, b.slot, all + first[begin / kPointGrain],
                           row_stride(first.back()), out.subspan(begin, end - begin));
    });
  }

  void start_hips(Turn& turn, std::span<const Vec3> hips, std::size_t methods) const {
    const std::size_t count = hips.size();
    turn.in.resize(6 * count);
    turn.out.resize(kContactReals * row_stride(methods * count));
    turn.out_index.resize(kContactUints * row_stride(methods * count));
    Real* in = turn.in.data();
    for_pieces(count, [&](std::size_t i) {
      const RawHip<Real> hip = raw_hip<Real>(cache_, hips[i]);
      for (std::size_t r = 0; r < 6; ++r) in[r * count + i] = hip.parts[r];
    });
    turn.in.upload();
  }

  // Contacts from column `first` on of rows of `stride`.
  void finish_contacts(Turn& turn, std::size_t first, std::size_t stride,
                       std::span<Contact> out) const {
    const Real* reals = turn.out.data() + first;
    const cl_uint* uints = turn.out_index.data() + first;
    for_pieces(out.size(), [&](std::size_t i) {
      RawContact<Real> raw;
      for (std::size_t r = 0; r < kContactReals; ++r) raw.reals[r] = reals[r * stride + i];
      for (std::size_t r = 0; r < kContactUints; ++r) raw.uints[r] = uints[r * stride + i];
      out[i] = contact_of(cache_, surface_, raw);
    });
  }

  const OpenClShared& shared_;
  const PatchCache& cache_;
  const Surface<Real>& surface_;
  const std::unique_ptr<ResidentSurface> host_;
  const std::size_t lanes_;
  const DeviceSurface<Real> there_;
  mutable std::mutex mutex_;
  mutable Kernel evaluate_{kEvaluateProgram, "evaluate_blocks", static_cast<int>(lanes_), {}};
  mutable Kernel nearest_{kQueryProgram, "nearest", 1, {}}, track_{kQueryProgram, "track", 1, {}};
  mutable std::array<Turn, 2> turns_;
};

}  // namespace

std::unique_ptr<ResidentSurface> make_opencl_surface(const OpenClShared& shared,
                                                     const PatchCache& cache) {
  require_patches(cache);
  shared.device.require(cache.precision());
  return with_surface(cache,
                      [&]<class Real>(const Surface<Real>& s) -> std::unique_ptr<ResidentSurface> {
                        return std::make_unique<OpenClSurface<Real>>(shared, cache, s);
                      });
}

}  // namespace gliss
