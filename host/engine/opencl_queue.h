// Work under way on a device: arrays that travel, kernels that run, and the time they take.
#pragma once

#include <utility>
#include <vector>

#include "gliss/engine/opencl_device.h"

namespace gliss {

// An array on the device and where the host reads and writes it: mapped if they share their memory,
// else a copy in pinned memory. Grows, never shrinks.
template <class T>
class Staging {
 public:
  Staging(const Device& device, const cl::CommandQueue& queue, const char* what)
      : device_(device), queue_(queue), what_(what) {}
  ~Staging() {  // by the C call: destructors do not throw
    if (here_ != nullptr) clEnqueueUnmapMemObject(queue_(), pinned_(), here_, 0, nullptr, nullptr);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  // The device may use it from here on, the host after data().
  void resize(std::size_t size) {
    size_ = size;
    const bool grows = size > capacity_;
    if (grows || shared()) unmap();
    if (!grows) return;
    capacity_ = 0;
    const cl_mem_flags here = CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR;
    pinned_ = device_.buffer(size * sizeof(T), here, what_);
    there_ = shared() ? pinned_ : device_.buffer(size * sizeof(T), CL_MEM_READ_WRITE, what_);
    capacity_ = size;
  }
  // For the host, while the queue is idle.
  T* data() {
    if (here_ == nullptr) {
      here_ = static_cast<T*>(queue_.enqueueMapBuffer(pinned_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE,
                                                      0, capacity_ * sizeof(T)));
    }
    return here_;
  }
  const cl::Buffer& buffer() const { return there_; }
  // All from `first` on.
  void upload(std::size_t first = 0) {
    if (shared()) {
      unmap();
    } else if (first < size_) {
      queue_.enqueueWriteBuffer(there_, CL_FALSE, first * sizeof(T), (size_ - first) * sizeof(T),
                                data() + first);
    }
  }
  void download() { download(size_); }
  // The first `count`.
  void download(std::size_t count) {
    if (!shared() && count > 0)
      queue_.enqueueReadBuffer(there_, CL_FALSE, 0, count * sizeof(T), data());
  }

 private:
  bool shared() const { return device_.info().shares_memory; }
  void unmap() {
    if (here_ != nullptr) queue_.enqueueUnmapMemObject(pinned_, std::exchange(here_, nullptr));
  }

  const Device& device_;
  const cl::CommandQueue& queue_;
  const char* what_;
  cl::Buffer there_, pinned_;
  T* here_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

// A kernel of the caller's own, its leading arguments set once.
class Launch {
 public:
  template <class... Leading>
  Launch(const Device& device, const char* program, const char* name, const ProgramVariant& variant,
         const Leading&... leading)
      : device_(device), kernel_(device.kernel(program, name, variant)) {
    set(0, leading...);
    leading_ = sizeof...(leading);
  }

  // Runs `count` work-items; the kernel's arguments are the leading ones, count, and these.
  template <class... Args>
  cl::Event operator()(const cl::CommandQueue& queue, std::size_t count, const Args&... args) {
    set(leading_ + 1, args...);
    if (!warm_) {  // compiled for the size of its groups at its first start
      set(leading_, cl_uint{0});
      device_.patiently(
          [kernel = kernel_, own = cl::CommandQueue(device_.context(), device_.id())] {
            own.enqueueNDRangeKernel(kernel, cl::NullRange, kGroup, kGroup);
            own.finish();
          });
      warm_ = true;
    }
    set(leading_, static_cast<cl_uint>(count));
    cl::Event done;
    const std::size_t padded = (count + kGroup - 1) / kGroup * kGroup;
    queue.enqueueNDRangeKernel(kernel_, cl::NullRange, padded, kGroup, nullptr, &done);
    return done;
  }

 private:
  template <class... Args>
  void set(cl_uint index, const Args&... args) {
    (kernel_.setArg(index++, args), ...);
  }

  const Device& device_;
  cl::Kernel kernel_;
  cl_uint leading_ = 0;
  bool warm_ = false;
};

}  // namespace gliss
