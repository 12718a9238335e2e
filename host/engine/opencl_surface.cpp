// Queries on an OpenCL device. The host places points and HIPs in the frames of the kernels and
// takes results back, in pieces on all cores; two queues take flights, so that one's transfers and
// host work overlap the other's kernels.
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <vector>

#include "gliss/engine/opencl_arrays.h"
#include "gliss/engine/opencl_queue.h"
#include "gliss/engine/opencl_shared.h"
#include "gliss/query/frames.h"
#include "gliss/query/placed_points.h"

namespace gliss {
namespace {

constexpr std::size_t kPointBlock = 4096, kHipBlock = 1024;
// At once on a processor: fewer and they wait for each other more, more and they leave its caches.
constexpr std::size_t kPoints = 1 << 18, kHips = 1 << 16;
constexpr std::size_t kGridPoints = 1 << 22;

template <class Real>
bool has_many_valences(const Surface<Real>& s) {
  for (std::uint32_t p = 1; p < s.patch_count(); ++p) {
    if (s.valence(p) != s.valence(0)) return true;
  }
  return false;
}

template <class Real>
class OpenClSurface final : public ResidentSurface {
 public:
  OpenClSurface(const OpenClShared& shared, const PatchCache& cache, const Surface<Real>& s)
      : shared_(shared),
        cache_(cache),
        surface_(s),
        host_(shared.host->reside(cache)),
        lanes_(static_cast<std::size_t>(shared.lanes(kPrecision<Real>))),
        is_mixed_(has_many_valences(s)),
        there_(shared.device, s),
        flights_{Flight(shared), Flight(shared)} {}

  void evaluate(const PointArrays<double>& points,
                const SurfaceArrays<double>& out) const override {
    evaluate_there(points, out);
  }
  void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const double> xi,
                     std::span<const double> eta, const SurfaceArrays<double>& out) const override {
    grid_there(faces, xi, eta, out);
  }
  void nearest(const HipArrays<double>& hips, std::span<const Method> methods,
               const QueryOptions& options,
               std::span<const ContactArrays<double>> out) const override {
    nearest_there(hips, methods, options, out);
  }
  void track(const HipArrays<double>& hips, const PointArrays<double>& starts,
             const QueryOptions& options, const ContactArrays<double>& out) const override {
    track_there(hips, starts, options, out);
  }
  void evaluate(const PointArrays<float>& points, const SurfaceArrays<float>& out) const override {
    evaluate_there(points, out);
  }
  void evaluate_grid(std::span<const std::uint32_t> faces, std::span<const float> xi,
                     std::span<const float> eta, const SurfaceArrays<float>& out) const override {
    grid_there(faces, xi, eta, out);
  }
  void nearest(const HipArrays<float>& hips, std::span<const Method> methods,
               const QueryOptions& options,
               std::span<const ContactArrays<float>> out) const override {
    nearest_there(hips, methods, options, out);
  }
  void track(const HipArrays<float>& hips, const PointArrays<float>& starts,
             const QueryOptions& options, const ContactArrays<float>& out) const override {
    track_there(hips, starts, options, out);
  }

 private:
  template <class T>
  void evaluate_there(const PointArrays<T>& points, const SurfaceArrays<T>& out) const {
    on_device(
        points.count, kPoints, 11 * sizeof(Real) * lanes_,
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          start_evaluate(flight, points, begin, count);
        },
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          finish_evaluate(flight, out.from(begin), count);
        },
        [&] { host_->evaluate(points, out); });
  }

  // As points of any faces, some at a time.
  template <class T>
  void grid_there(std::span<const std::uint32_t> faces, std::span<const T> xi,
                  std::span<const T> eta, const SurfaceArrays<T>& out) const {
    if (xi.size() != eta.size() || faces.size() * xi.size() < shared_.options.smallest_batch)
      return host_->evaluate_grid(faces, xi, eta, out);
    std::vector<std::uint32_t> face;
    std::vector<T> xis, etas;
    const std::size_t at_once = std::max<std::size_t>(1, kGridPoints / xi.size());
    for (std::size_t begin = 0; begin < faces.size(); begin += at_once) {
      face.clear(), xis.clear(), etas.clear();
      for (std::size_t i = begin; i < std::min(faces.size(), begin + at_once); ++i) {
        face.insert(face.end(), xi.size(), faces[i]);
        xis.insert(xis.end(), xi.begin(), xi.end());
        etas.insert(etas.end(), eta.begin(), eta.end());
      }
      evaluate_there<T>({face.size(), {face.data()}, {xis.data()}, {etas.data()}},
                        out.from(begin * xi.size()));
    }
  }

  template <class T>
  void nearest_there(const HipArrays<T>& hips, std::span<const Method> methods,
                     const QueryOptions& options, std::span<const ContactArrays<T>> out) const {
    require_room(kMethods, methods.size());
    require_room(out.size(), methods.size());
    if (cache_.winding != nullptr) return host_->nearest(hips, methods, options, out);
    cl_uint packed = 0;
    for (std::size_t m = 0; m < methods.size(); ++m)
      packed |= static_cast<cl_uint>(methods[m]) << 4 * m;
    const TrackOptions<Real> track = track_options<Real>(options);
    on_device(
        hips.count, kHips, hip_bytes(methods.size()),
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          start_hips(flight, hips, begin, count, methods.size());
          flight.ran(kernel(nearest_)(
              flight.queue, count, flight.in.buffer(), packed, static_cast<cl_uint>(methods.size()),
              static_cast<cl_int>(track.solver), static_cast<cl_int>(track.max_iterations),
              track.tolerance, static_cast<cl_int>(track.budget), flight.out.buffer(),
              flight.out_index.buffer()));
          flight.out.download();
          flight.out_index.download();
        },
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          for (std::size_t m = 0; m < methods.size(); ++m)
            finish_contacts(flight, m * count, row_stride(methods.size() * count), count,
                            out[m].from(begin));
        },
        [&] { host_->nearest(hips, methods, options, out); });
  }

  template <class T>
  void track_there(const HipArrays<T>& hips, const PointArrays<T>& starts,
                   const QueryOptions& options, const ContactArrays<T>& out) const {
    require_room(starts.count, hips.count);
    const TrackOptions<Real> track = track_options<Real>(options);
    on_device(
        hips.count, kHips, hip_bytes(1) + 2 * sizeof(Real) + sizeof(cl_uint),
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          start_hips(flight, hips, begin, count, 1);
          flight.start.resize(2 * count);
          flight.in_index.resize(count);
          Real* start = flight.start.data();
          cl_uint* patch = flight.in_index.data();
          for_pieces(count, [&](std::size_t i) {
            const PatchPlace place = place_of(cache_, surface_, point_at(starts, begin + i));
            patch[i] = place.patch;
            start[i] = static_cast<Real>(place.xi);
            start[count + i] = static_cast<Real>(place.eta);
          });
          flight.start.upload();
          flight.in_index.upload();
          flight.ran(kernel(track_)(
              flight.queue, count, flight.in.buffer(), flight.in_index.buffer(),
              flight.start.buffer(), static_cast<cl_int>(options.method),
              static_cast<cl_int>(track.solver), static_cast<cl_int>(track.max_iterations),
              track.tolerance, static_cast<cl_int>(track.budget), flight.out.buffer(),
              flight.out_index.buffer()));
          flight.out.download();
          flight.out_index.download();
        },
        [&](Flight& flight, std::size_t begin, std::size_t count) {
          finish_contacts(flight, 0, row_stride(count), count, out.from(begin));
        },
        [&] { host_->track(hips, starts, options, out); });
  }

  // Points of a piece in blocks of as many lanes, each of one patch; what is over in a block
  // repeats its first.
  struct Blocks {
    PlacedPoints<Real> points;
    PatchOrder order;
    std::vector<PatchRun> runs;
    std::vector<std::uint32_t> block_patch;  // [block]
    std::vector<std::uint32_t> patch, slot;  // [point], its patch and place among the blocks' lanes
  };

  // One of the two queues with its arrays.
  struct Flight {
    const OpenClShared& shared;
    cl::CommandQueue queue;
    Staging<Real> in, start, out;
    Staging<cl_uint> in_index, out_index;
    std::vector<Blocks> blocks;        // of pieces of points
    std::vector<cl::Event> kernels;    // not yet timed
    std::size_t begin = 0, count = 0;  // of what is under way

    explicit Flight(const OpenClShared& s)
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
           methods * (CONTACT_REALS * sizeof(Real) + CONTACT_UINTS * sizeof(cl_uint));
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
          const Idle idle{flights_};
          const std::size_t chunk = chunk_of(count, at_once, bytes);
          const auto collect = [&](Flight& flight) {
            if (flight.count == 0) return;
            flight.wait();
            finish(flight, flight.begin, std::exchange(flight.count, 0));
          };
          for (std::size_t begin = 0, i = 0; begin < count; begin += chunk, ++i) {
            Flight& flight = flights_[i % 2];
            collect(flight);
            flight.begin = begin;
            const std::size_t size = std::min(chunk, count - begin);
            start(flight, begin, size);
            flight.queue.flush();
            flight.count = size;
          }
          const bool second = flights_[0].begin > flights_[1].begin;
          collect(flights_[second]);
          collect(flights_[!second]);
        },
        on_host);
  }

  // Nothing is under way when work ends, however it ends.
  struct Idle {
    std::array<Flight, 2>& flights;
    ~Idle() {
      for (Flight& flight : flights) {
        clFinish(flight.queue());
        flight.kernels.clear();
        flight.count = 0;
      }
    }
  };

  template <class Body>
  void for_pieces(std::size_t count, Body body) const {
    shared_.host->for_each(count, kHipBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  template <class T>
  void block_points(const PointArrays<T>& points, std::size_t begin, std::size_t count,
                    Blocks& b) const {
    b.points.take(cache_, surface_, points, begin, count);
    const bool in_runs = b.order.judge(b.points.runs, lanes_) == PatchOrder::kInRuns;
    if (!in_runs) b.order.sort();
    b.runs = in_runs ? b.points.runs : b.order.runs;
    if (!in_runs && is_mixed_) {
      // Neighbours of one valence take the same way through a kernel.
      std::stable_sort(b.runs.begin(), b.runs.end(), [&](const PatchRun& p, const PatchRun& q) {
        return surface_.valence(p.patch) < surface_.valence(q.patch);
      });
    }
    b.block_patch.clear();
    b.patch.resize(count), b.slot.resize(count);
    for (const PatchRun& run : b.runs) {
      const std::size_t first = b.block_patch.size() * lanes_, points = run.end - run.begin;
      b.block_patch.insert(b.block_patch.end(), (points + lanes_ - 1) / lanes_, run.patch);
      for (std::size_t i = 0; i < points; ++i) {
        const std::size_t at = in_runs ? run.begin + i : b.order.order[run.begin + i];
        b.patch[at] = run.patch;
        b.slot[at] = static_cast<std::uint32_t>(first + i);
      }
    }
  }

  template <class T>
  void start_evaluate(Flight& flight, const PointArrays<T>& points, std::size_t from,
                      std::size_t size) const {
    const std::size_t pieces = (size + kPointBlock - 1) / kPointBlock;
    flight.blocks.resize(pieces);
    shared_.host->for_each(size, kPointBlock, [&](std::size_t begin, std::size_t end) {
      block_points(points, from + begin, end - begin, flight.blocks[begin / kPointBlock]);
    });
    std::vector<std::size_t> first(pieces + 1, 0);  // block of each piece
    for (std::size_t i = 0; i < pieces; ++i)
      first[i + 1] = first[i] + flight.blocks[i].block_patch.size();
    const std::size_t count = first.back(), slots = count * lanes_;
    flight.in_index.resize(count);
    flight.in.resize(2 * slots);
    flight.out.resize(9 * row_stride(slots));
    cl_uint* patch = flight.in_index.data();
    Real* in = flight.in.data();
    shared_.host->for_each(pieces, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        copy_blocks(flight.blocks[i], patch + first[i], in + first[i] * lanes_, slots);
    });
    flight.in_index.upload();
    flight.in.upload();
    flight.ran(kernel(evaluate_)(flight.queue, count, flight.in_index.buffer(), flight.in.buffer(),
                                 flight.out.buffer()));
    flight.out.download();
  }

  // Rows of xi and eta, `stride` apart.
  void copy_blocks(const Blocks& b, cl_uint* patch, Real* in, std::size_t stride) const {
    std::copy(b.block_patch.begin(), b.block_patch.end(), patch);
    for (std::size_t i = 0; i < b.slot.size(); ++i) {
      in[b.slot[i]] = b.points.xi[i];
      in[stride + b.slot[i]] = b.points.eta[i];
    }
    std::size_t filled = 0;  // lanes
    for (const PatchRun& run : b.runs) {
      const std::size_t end = filled + (run.end - run.begin);
      const std::size_t last = (end - 1) / lanes_ * lanes_;  // block
      for (filled = end; filled < last + lanes_; ++filled) {
        in[filled] = in[last];
        in[stride + filled] = in[stride + last];
      }
    }
  }

  template <class T>
  void finish_evaluate(Flight& flight, const SurfaceArrays<T>& out, std::size_t count) const {
    std::vector<std::size_t> first(flight.blocks.size() + 1, 0);  // slot of each piece
    for (std::size_t i = 0; i < flight.blocks.size(); ++i)
      first[i + 1] = first[i] + flight.blocks[i].block_patch.size() * lanes_;
    const Real* all = flight.out.data();
    const std::size_t stride = row_stride(first.back());
    shared_.host->for_each(count, kPointBlock, [&](std::size_t begin, std::size_t end) {
      const Blocks& b = flight.blocks[begin / kPointBlock];
      const Real* there = all + first[begin / kPointBlock];
      constexpr std::size_t kRows = 256, kStride = row_stride(kRows);
      Real rows[9 * kStride];
      for (std::size_t at = begin; at < end; at += kRows) {
        const std::size_t many = std::min(kRows, end - at);
        for (std::size_t r = 0; r < 9; ++r) {
          for (std::size_t i = 0; i < many; ++i)
            rows[r * kStride + i] = there[r * stride + b.slot[at - begin + i]];
        }
        place_points<Real>(cache_, surface_, {rows, kStride, many, &b.patch[at - begin], 1, at},
                           out);
      }
    });
  }

  template <class T>
  void start_hips(Flight& flight, const HipArrays<T>& hips, std::size_t begin, std::size_t count,
                  std::size_t methods) const {
    flight.in.resize(6 * count);
    flight.out.resize(CONTACT_REALS * row_stride(methods * count));
    flight.out_index.resize(CONTACT_UINTS * row_stride(methods * count));
    Real* in = flight.in.data();
    for_pieces(count, [&](std::size_t i) {
      const RawHip<Real> hip = raw_hip<Real>(cache_, hip_at(hips, begin + i));
      for (std::size_t r = 0; r < 6; ++r) in[r * count + i] = hip.parts[r];
    });
    flight.in.upload();
  }

  // Contacts from column `first` on of rows of `stride`.
  template <class T>
  void finish_contacts(Flight& flight, std::size_t first, std::size_t stride, std::size_t count,
                       const ContactArrays<T>& out) const {
    const Real* reals = flight.out.data() + first;
    const cl_uint* uints = flight.out_index.data() + first;
    for_pieces(count, [&](std::size_t i) {
      RawContact<Real> raw;
      for (std::size_t r = 0; r < CONTACT_REALS; ++r) raw.reals[r] = reals[r * stride + i];
      for (std::size_t r = 0; r < CONTACT_UINTS; ++r) raw.uints[r] = uints[r * stride + i];
      store_contact(cache_, surface_, raw, out, i);
    });
  }

  const OpenClShared& shared_;
  const PatchCache& cache_;
  const Surface<Real>& surface_;
  const std::unique_ptr<ResidentSurface> host_;
  const std::size_t lanes_;
  const bool is_mixed_;  // of faces with different numbers of sides
  const DeviceSurface<Real> there_;
  mutable std::mutex mutex_;
  mutable Kernel evaluate_{kEvaluateProgram, "evaluate_blocks", static_cast<int>(lanes_), {}};
  mutable Kernel nearest_{kNearestProgram, "nearest", 1, {}}, track_{kTrackProgram, "track", 1, {}};
  mutable std::array<Flight, 2> flights_;
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
