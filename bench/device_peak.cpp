#include "bench/device_peak.h"

#include <algorithm>
#include <cstdio>

#include "gliss/engine/opencl_device.h"

namespace gliss::bench {
namespace {

// Eight independent chains of fma, of vectors as wide as the device takes; a copy of float4.
const char* const kPeakProgram = R"cl(
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if GLISS_LANES == 1
typedef float wide;
#else
typedef JOIN(float, GLISS_LANES) wide;
#endif
__kernel void operations(uint rounds, __global float* out) {
  const wide a = (wide)(0.999f), b = (wide)(1e-4f);
  const float start = 1e-3f * (get_global_id(0) % 64);
  wide p = (wide)(start), q = p + 1, r = p + 2, s = p + 3, t = p + 4, u = p + 5, v = p + 6, w = p + 7;
  for (uint i = 0; i < rounds; ++i) {
    p = fma(p, a, b);
    q = fma(q, a, b);
    r = fma(r, a, b);
    s = fma(s, a, b);
    t = fma(t, a, b);
    u = fma(u, a, b);
    v = fma(v, a, b);
    w = fma(w, a, b);
  }
  const wide sum = p + q + r + s + t + u + v + w;
  out[get_global_id(0)] = ((const float*)&sum)[0];
}
__kernel void copy(__global const float4* from, __global float4* to) {
  to[get_global_id(0)] = from[get_global_id(0)];
}
)cl";

// Seconds of the fastest of some runs.
double best(const cl::CommandQueue& queue, const cl::Kernel& kernel, std::size_t items) {
  double seconds = 1e30;
  for (int i = 0; i < 8; ++i) {
    cl::Event event;
    queue.enqueueNDRangeKernel(kernel, cl::NullRange, items, kGroup, nullptr, &event);
    event.wait();
    const auto ns = event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                    event.getProfilingInfo<CL_PROFILING_COMMAND_START>();
    seconds = std::min(seconds, 1e-9 * static_cast<double>(ns));
  }
  return seconds;
}

}  // namespace

DevicePeak measure_peak(const std::string& name) {
  OpenClOptions options;
  options.device = name;
  const Device device(options);
  const cl::CommandQueue queue(device.context(), device.id(), CL_QUEUE_PROFILING_ENABLE);
  const bool gpu = device.info().type == "GPU";
  const int lanes = device.info().lanes_float;

  const std::size_t items = gpu ? 1 << 20 : 1 << 12;
  const cl_uint rounds = 4096;
  const cl::Buffer out = device.buffer(items * sizeof(float), CL_MEM_READ_WRITE, "a benchmark");
  cl::Kernel operations = device.kernel(kPeakProgram, "operations", {Precision::kFloat, lanes});
  operations.setArg(0, rounds);
  operations.setArg(1, out);

  const std::size_t bytes = std::size_t{1} << (gpu ? 30 : 27), quads = bytes / 16;
  const cl::Buffer from = device.buffer(bytes, CL_MEM_READ_WRITE, "a benchmark"),
                   to = device.buffer(bytes, CL_MEM_READ_WRITE, "a benchmark");
  cl::Kernel copy = device.kernel(kPeakProgram, "copy", {Precision::kFloat, lanes});
  copy.setArg(0, from);
  copy.setArg(1, to);

  DevicePeak peak;
  peak.operations =
      2.0 * 8 * lanes * rounds * static_cast<double>(items) / best(queue, operations, items);
  peak.bandwidth = 2.0 * static_cast<double>(bytes) / best(queue, copy, quads);
  std::printf("%s: %.3g float operations/s, %.3g bytes/s at most\n", device.info().name.c_str(),
              peak.operations, peak.bandwidth);
  return peak;
}

}  // namespace gliss::bench
