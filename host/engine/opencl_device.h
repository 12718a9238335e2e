// One OpenCL device with its context and programs. Only host/opencl_*.cpp include this.
#pragma once

#define CL_HPP_ENABLE_EXCEPTIONS
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#include <CL/opencl.hpp>
#include <algorithm>
#include <atomic>
#include <future>
#include <map>
#include <mutex>
#include <string>
#include <tuple>

#include "gliss/base/poll.h"
#include "gliss/engine/opencl.h"
#include "gliss/surface/layout.h"

namespace gliss {

// The text of kernels/*.cl with all that they include; made by tools/embed_texts.py.
extern const char* const kBuildProgram;
extern const char* const kEvaluateProgram;
extern const char* const kExamineProgram;
extern const char* const kNearestProgram;
extern const char* const kTrackProgram;

// Work-items of a group: fixed, because PoCL compiles for each size anew and wants whole groups.
inline constexpr std::size_t kGroup = 64;

// The kinds of patches that a program has code for, as bits (kernels/forms.h): for all of them a
// GPU's driver compiles a minute.
struct PatchKinds {
  std::uint32_t forms = 0, valences = 0;

  void add(std::uint32_t form, std::size_t valence) {
    forms |= 1u << (form & kFormMask);
    valences |= 1u << std::min<std::size_t>(valence, kManySides);
  }
  auto operator<=>(const PatchKinds&) const = default;
};

// The options that a program is compiled with.
struct ProgramVariant {
  Precision precision;
  int lanes;
  PatchKinds kinds = {};

  auto operator<=>(const ProgramVariant&) const = default;
};

class Device {
 public:
  explicit Device(const OpenClOptions& options);

  const OpenClDevice& info() const { return info_; }
  const cl::Context& context() const { return context_; }
  const cl::Device& id() const { return id_; }
  std::uint64_t memory() const { return memory_; }  // to be used at most, bytes

  // Throws where the device cannot do the precision.
  void require(Precision precision) const;
  // Throws where `bytes` are more than may be used; `who` starts the line: "the patches need".
  void require_room(std::uint64_t bytes, const std::string& who) const;
  // A kernel object of its own for the caller; its program is compiled when first asked for.
  cl::Kernel kernel(const char* program, const char* name, const ProgramVariant& variant) const;
  // A buffer for `bytes` of `what`.
  cl::Buffer buffer(std::size_t bytes, cl_mem_flags flags, const std::string& what) const;
  // Does what may compile kernels, and says so when it takes long: drivers keep what they compiled,
  // and are quick the next time. No compiler can be stopped: after poll has thrown, `work` goes on
  // by itself, and so it must own what it uses.
  void patiently(std::function<void()> work) const;
  // An error's text, as one line.
  DeviceError error(const cl::Error& error) const;
  DeviceError error(const std::string& problem) const;

 private:
  cl::Program compile(const char* text, const ProgramVariant& variant) const;
  void await_compiler(const std::future<void>& done) const;

  OpenClDevice info_;
  cl::Device id_;
  cl::Context context_;
  std::uint64_t memory_ = 0;
  std::function<void(const std::string&)> notice_;
  Poll poll_;
  mutable std::atomic<bool> noticed_ = false;
  mutable std::mutex mutex_;
  mutable std::map<std::pair<const char*, ProgramVariant>, cl::Program> programs_;
};

}  // namespace gliss
