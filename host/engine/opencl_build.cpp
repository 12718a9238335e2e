// Patches built and examined on an OpenCL device: always in double, as on the host, so that a
// device without fp64 leaves it to the host.
#include <algorithm>
#include <optional>

#include "gliss/build/patch_batch.h"
#include "gliss/engine/opencl_queue.h"
#include "gliss/engine/opencl_shared.h"
#include "gliss/surface/instances.h"
#include "gliss/surface/layout.h"

namespace gliss {
namespace {

// Fewer patches are built on the host: one takes as long as some points of a query.
constexpr std::size_t kPointsPerPatch = 16;

// On the device, but for the tables.
constexpr std::size_t kPatchBytes =
                          (kShapeReals + kFrameReals) * sizeof(double) + 4 * sizeof(cl_uint),
                      kSideBytes = (6 + 1) * sizeof(double) + (1 + 3) * sizeof(cl_uint);

class OpenClBuilder {
 public:
  explicit OpenClBuilder(const OpenClShared& shared)
      : shared_(shared),
        queue_(shared.device.context(), shared.device.id(), CL_QUEUE_PROFILING_ENABLE) {}

  void run(PatchBatch& b) {
    const Idle idle{queue_};
    shared_.device.require_room(b.size() * kPatchBytes + b.side_begin.back() * kSideBytes +
                                    (b.control.size() + b.sample_begin.back()) * sizeof(double),
                                "a batch of patches needs");
    std::vector<cl::Event> kernels;
    upload(begins_, b.side_begin);
    upload(corner_, b.corner);
    upload_drafted(b);
    if (b.to_build > 0) kernels.push_back(build(b));
    kernels.push_back(examine(b));
    control_.download(b.control_begin[b.to_build]);
    if (b.to_build > 0) sound_.download();
    sample_.download();
    shape_.download();
    queue_.finish();
    shared_.count(kernels);
    take_results(b);
  }

 private:
  // Uploads the control data of the patches that come drafted.
  void upload_drafted(const PatchBatch& b) {
    const std::size_t first = b.control_begin[b.to_build];
    control_.resize(b.control.size());
    if (first == b.control.size()) return;
    std::copy(b.control.begin() + static_cast<std::ptrdiff_t>(first), b.control.end(),
              control_.data() + first);
    control_.upload(first);
  }

  // Computes the control data of the other patches.
  cl::Event build(const PatchBatch& b) {
    const std::size_t sides = b.side_begin[b.to_build];
    side_patch_.resize(sides);
    cl_uint* side_patch = side_patch_.data();
    for (std::size_t p = 0; p < b.to_build; ++p) {
      std::fill(side_patch + b.side_begin[p], side_patch + b.side_begin[p + 1],
                static_cast<cl_uint>(p));
    }
    side_patch_.upload();
    sound_.resize(sides);
    if (!build_)
      build_.emplace(shared_.device, kBuildProgram, "build_sides",
                     ProgramVariant{Precision::kDouble, 1});
    return (*build_)(queue_, sides, begins_.buffer(), side_patch_.buffer(), corner_.buffer(),
                     control_.buffer(), sound_.buffer());
  }

  cl::Event examine(const PatchBatch& b) {
    upload(triangle_, b.triangle);
    upload(frame_, b.frame);
    upload(form_, b.form);
    upload(control_begin_, b.control_begin);
    upload(domain_, b.tables->domain);
    upload(probe_, b.tables->probe);
    upload(domain_begin_, b.tables->domain_begin);
    upload(probe_begin_, b.tables->probe_begin);
    upload(second_, b.tables->second);
    upload(second_begin_, b.tables->second_begin);
    upload(sample_begin_, b.sample_begin);
    sample_.resize(b.sample_begin.back());
    shape_.resize(b.size() * kShapeReals);
    return examiner_of(b)(queue_, b.size(), domain_.buffer(), domain_begin_.buffer(),
                          probe_.buffer(), probe_begin_.buffer(), begins_.buffer(),
                          corner_.buffer(), triangle_.buffer(), frame_.buffer(), control_.buffer(),
                          control_begin_.buffer(), form_.buffer(), second_.buffer(),
                          second_begin_.buffer(), sample_begin_.buffer(), sample_.buffer(),
                          shape_.buffer());
  }

  // Examines patches of all kinds so far, for which it is compiled anew where a batch has more.
  Launch& examiner_of(const PatchBatch& b) {
    PatchKinds kinds = examined_;
    for (std::size_t p = 0; p < b.size(); ++p)
      kinds.add(b.form[p], b.side_begin[p + 1] - b.side_begin[p]);
    if (!examine_ || kinds != examined_) {
      const int lanes = shared_.lanes(Precision::kDouble);
      examine_.emplace(shared_.device, kExamineProgram, "examine_patches",
                       ProgramVariant{Precision::kDouble, lanes, kinds});
      examined_ = kinds;
    }
    return *examine_;
  }

  // Maps all results before it writes any: a call that fails leaves the batch to the host.
  void take_results(PatchBatch& b) {
    const double *shape = shape_.data(), *sample = sample_.data(), *control = control_.data(),
                 *sound = b.to_build > 0 ? sound_.data() : nullptr;
    b.shape.assign(shape, shape + b.size() * kShapeReals);
    b.sample.assign(sample, sample + b.sample_begin.back());
    std::copy_n(control, b.control_begin[b.to_build], b.control.begin());
    for (std::size_t p = 0; p < b.to_build; ++p)
      b.soundness[p] = *std::min_element(sound + b.side_begin[p], sound + b.side_begin[p + 1]);
  }

  // Nothing is under way when work ends, however it ends.
  struct Idle {
    const cl::CommandQueue& queue;
    ~Idle() { clFinish(queue()); }
  };

  template <class T>
  static void upload(Staging<T>& there, const std::vector<T>& here) {
    there.resize(std::max<std::size_t>(here.size(), 1));  // no buffer is empty
    std::copy(here.begin(), here.end(), there.data());
    there.upload();
  }

  const OpenClShared& shared_;
  cl::CommandQueue queue_;
  std::optional<Launch> build_, examine_;
  PatchKinds examined_;
  Staging<cl_uint> begins_{shared_.device, queue_, "the polygons"};
  Staging<cl_uint> side_patch_{shared_.device, queue_, "the polygons"};
  Staging<cl_uint> triangle_{shared_.device, queue_, "the polygons"};
  Staging<double> corner_{shared_.device, queue_, "the polygons"};
  Staging<double> frame_{shared_.device, queue_, "the polygons"};
  Staging<cl_uint> form_{shared_.device, queue_, "the polygons"};
  Staging<double> domain_{shared_.device, queue_, "the tables"};
  Staging<double> probe_{shared_.device, queue_, "the tables"};
  Staging<cl_uint> domain_begin_{shared_.device, queue_, "the tables"};
  Staging<cl_uint> probe_begin_{shared_.device, queue_, "the tables"};
  Staging<double> second_{shared_.device, queue_, "the tables"};
  Staging<cl_uint> second_begin_{shared_.device, queue_, "the tables"};
  Staging<cl_uint> control_begin_{shared_.device, queue_, "the control data"};
  Staging<double> control_{shared_.device, queue_, "the control data"};
  Staging<double> sound_{shared_.device, queue_, "the control data"};
  Staging<cl_uint> sample_begin_{shared_.device, queue_, "the samples"};
  Staging<double> sample_{shared_.device, queue_, "the samples"};
  Staging<double> shape_{shared_.device, queue_, "the shapes"};
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
