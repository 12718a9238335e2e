// Patches built and examined on an OpenCL device: always in double, as on the host, so that a
// device without fp64 leaves it to the host.
#include <algorithm>

#include "gliss/engine/opencl_queue.h"
#include "gliss/engine/opencl_shared.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// Fewer patches are built on the host: one takes as long as some points of a query.
constexpr std::size_t kPointsPerPatch = 16;

// On the device, but for the tables.
constexpr std::size_t kPatchBytes = (kShapeReals + kFrameReals) * sizeof(double) + sizeof(cl_uint),
                      kSideBytes =
                          (kSideReals + 6 + 1) * sizeof(double) + (1 + 3) * sizeof(cl_uint);

class OpenClBuilder {
 public:
  explicit OpenClBuilder(const OpenClShared& shared)
      : shared_(shared),
        queue_(shared.device.context(), shared.device.id(), CL_QUEUE_PROFILING_ENABLE),
        build_(shared.device, kBuildProgram, "build_sides", {Precision::kDouble, 1}),
        examine_(shared.device, kExamineProgram, "examine_patches",
                 {Precision::kDouble, shared.lanes(Precision::kDouble)}),
        begins_(shared.device, queue_, "the polygons"),
        side_patch_(shared.device, queue_, "the polygons"),
        triangle_(shared.device, queue_, "the polygons"),
        corner_(shared.device, queue_, "the polygons"),
        frame_(shared.device, queue_, "the polygons"),
        domain_(shared.device, queue_, "the tables"),
        probe_(shared.device, queue_, "the tables"),
        domain_begin_(shared.device, queue_, "the tables"),
        probe_begin_(shared.device, queue_, "the tables"),
        control_(shared.device, queue_, "the control data"),
        sound_(shared.device, queue_, "the control data"),
        shape_(shared.device, queue_, "the shapes") {}

  void run(PatchBatch& b) {
    const Idle idle{queue_};
    const std::size_t patches = b.size(), sides = b.side_begin.back();
    shared_.device.require_room(patches * kPatchBytes + sides * kSideBytes,
                                "a batch of patches needs");
    upload(begins_, b.side_begin);
    upload(corner_, b.corner);
    side_patch_.resize(sides);
    cl_uint* side_patch = side_patch_.data();
    for (std::size_t p = 0; p < patches; ++p) {
      std::fill(side_patch + b.side_begin[p], side_patch + b.side_begin[p + 1],
                static_cast<cl_uint>(p));
    }
    side_patch_.upload();
    control_.resize(sides * kSideReals);
    sound_.resize(sides);
    std::vector<cl::Event> kernels;
    kernels.push_back(build_(queue_, sides, begins_.buffer(), side_patch_.buffer(),
                             corner_.buffer(), control_.buffer(), sound_.buffer()));
    upload(triangle_, b.triangle);
    upload(frame_, b.frame);
    upload(domain_, b.tables->domain);
    upload(probe_, b.tables->probe);
    upload(domain_begin_, b.tables->domain_begin);
    upload(probe_begin_, b.tables->probe_begin);
    shape_.resize(patches * kShapeReals);
    kernels.push_back(examine_(queue_, patches, domain_.buffer(), domain_begin_.buffer(),
                               probe_.buffer(), probe_begin_.buffer(), begins_.buffer(),
                               corner_.buffer(), triangle_.buffer(), frame_.buffer(),
                               control_.buffer(), shape_.buffer()));
    control_.download();
    sound_.download();
    shape_.download();
    queue_.finish();
    shared_.count(kernels);
    std::copy_n(control_.data(), b.control.size(), b.control.begin());
    b.shape.assign(shape_.data(), shape_.data() + patches * kShapeReals);
    const double* sound = sound_.data();
    for (std::size_t p = 0; p < patches; ++p)
      b.soundness[p] = *std::min_element(sound + b.side_begin[p], sound + b.side_begin[p + 1]);
  }

 private:
  // Nothing is under way when work ends, however it ends.
  struct Idle {
    const cl::CommandQueue& queue;
    ~Idle() { clFinish(queue()); }
  };

  template <class T>
  static void upload(Staging<T>& there, const std::vector<T>& here) {
    there.resize(here.size());
    std::copy(here.begin(), here.end(), there.data());
    there.upload();
  }

  const OpenClShared& shared_;
  cl::CommandQueue queue_;
  Launch build_, examine_;
  Staging<cl_uint> begins_, side_patch_, triangle_;
  Staging<double> corner_, frame_, domain_, probe_;
  Staging<cl_uint> domain_begin_, probe_begin_;
  Staging<double> control_, sound_, shape_;
};

}  // namespace

BatchBuilder make_opencl_builder(const OpenClShared& shared) {
  if (!shared.device.info().fp64) return build_patches;
  struct State {
    std::mutex mutex;
    std::unique_ptr<OpenClBuilder> builder;
  };
  return [&shared, state = std::make_shared<State>()](PatchBatch& b, const ParallelFor& parallel) {
    if (b.size() * kPointsPerPatch < shared.options.smallest_batch)
      return build_patches(b, parallel);
    const std::lock_guard lock(state->mutex);
    shared.run(
        [&] {
          if (state->builder == nullptr) state->builder = std::make_unique<OpenClBuilder>(shared);
          state->builder->run(b);
        },
        [&] { build_patches(b, parallel); });
  };
}

}  // namespace gliss
