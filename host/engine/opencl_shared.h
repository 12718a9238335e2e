// State that an OpenCL engine shares with its surfaces and builds.
#pragma once

#include <atomic>

#include "gliss/engine/opencl_device.h"

namespace gliss {

inline void tell_fallback(const OpenClOptions& options, const DeviceError& why) {
  if (options.notice) options.notice(std::string(why.what()) + "; going on with oneTBB");
}

struct OpenClShared {
  Device device;
  std::unique_ptr<Engine> host;
  OpenClOptions options;
  mutable std::atomic<double> kernel_seconds = 0;
  mutable std::atomic<bool> broken = false;  // the device has failed: the host does all

  explicit OpenClShared(const OpenClOptions& given)
      : device(given), host(make_tbb_engine(given.threads, given.poll)), options(given) {}

  // Runs on_device; what fails there is thrown, or left to on_host.
  template <class OnDevice, class OnHost>
  auto run(OnDevice on_device, OnHost on_host) const {
    if (broken) return on_host();
    try {
      try {
        return on_device();
      } catch (const cl::Error& e) {
        throw device.error(e);
      }
    } catch (const DeviceError& e) {
      if (!options.fall_back) throw;
      if (!broken.exchange(true)) tell_fallback(options, e);
    }
    return on_host();
  }

  // Adds the time that kernels took which have ended.
  void count(std::vector<cl::Event>& kernels) const {
    for (const cl::Event& e : kernels) {
      const auto ns = e.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                      e.getProfilingInfo<CL_PROFILING_COMMAND_START>();
      kernel_seconds += 1e-9 * static_cast<double>(ns);
    }
    kernels.clear();
  }

  int lanes(Precision precision) const {
    return precision == Precision::kFloat ? device.info().lanes_float : device.info().lanes_double;
  }
  bool on_gpu() const { return device.info().type == "GPU"; }
};

// The patches of a cache in the device's memory.
std::unique_ptr<ResidentSurface> make_opencl_surface(const OpenClShared& shared,
                                                     const PatchCache& cache);

// Builds batches of patches on the device. Shared must outlive it.
BatchBuilder make_opencl_builder(const OpenClShared& shared);

}  // namespace gliss
