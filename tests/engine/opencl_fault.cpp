// Stands before the OpenCL library, as a linked library or by LD_PRELOAD, and makes calls fail. As
// LD_PRELOAD it is told by GLISS_TEST_FAULT=FUNCTION:CALL:CODE, as clFinish:2:-5, by
// GLISS_TEST_DEVICE=INFO:VALUE, as 0x1010:4096 for CL_DEVICE_MAX_MEM_ALLOC_SIZE, and by
// GLISS_TEST_SLOW_BUILD=SECONDS.
#include "tests/engine/opencl_fault.h"

#include <dlfcn.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace gliss::test {
namespace {

struct State {
  std::mutex mutex;
  std::string function;
  int left = 0;  // calls until it fails
  cl_int code = CL_SUCCESS;
  bool failed = false;
  double build_seconds = 0;  // at least
  std::map<cl_device_info, cl_ulong> pretended;

  State() {
    char name[64];
    if (const char* text = std::getenv("GLISS_TEST_FAULT");
        text != nullptr && std::sscanf(text, "%63[^:]:%d:%d", name, &left, &code) == 3)
      function = name;
    unsigned info = 0;
    unsigned long long value = 0;
    if (const char* text = std::getenv("GLISS_TEST_DEVICE");
        text != nullptr && std::sscanf(text, "%x:%llu", &info, &value) == 2)
      pretended[info] = value;
    if (const char* text = std::getenv("GLISS_TEST_SLOW_BUILD")) build_seconds = std::atof(text);
  }
};

State& state() {
  static State state;
  return state;
}

// The error that this call of a function is to give, or CL_SUCCESS.
cl_int fault(const char* function) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  if (s.function != function || --s.left != 0) return CL_SUCCESS;
  s.failed = true;
  return s.code;
}

std::chrono::duration<double> build_time() {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  return std::chrono::duration<double>(s.build_seconds);
}

template <class Function>
Function* real(Function*, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// share_builds() keeps one context for all that ask for one, the text of each program, and the
// first program that was built of a text and its options, which others have their kernels from.
struct Builds {
  std::mutex mutex;
  bool shared = false;
  cl_context context = nullptr;
  std::map<cl_program, std::string> text;
  std::map<std::string, cl_program> built;  // [text and options]
  std::map<cl_program, cl_program> instead;
};

Builds& builds() {
  static Builds builds;
  return builds;
}

}  // namespace

void share_builds() {
  const std::lock_guard lock(builds().mutex);
  builds().shared = true;
}

void fail_call(const char* function, int at, cl_int code) {
  State& s = state();
  const std::lock_guard lock(s.mutex);
  s.function = function == nullptr ? "" : function;
  s.left = at;
  s.code = code;
  s.failed = false;
}

bool call_failed() {
  const std::lock_guard lock(state().mutex);
  return state().failed;
}

void slow_builds(double seconds) {
  const std::lock_guard lock(state().mutex);
  state().build_seconds = seconds;
}

void pretend(cl_device_info what, cl_ulong value) {
  const std::lock_guard lock(state().mutex);
  state().pretended[what] = value;
}

void pretend_nothing() {
  const std::lock_guard lock(state().mutex);
  state().pretended.clear();
}

}  // namespace gliss::test

using gliss::test::builds, gliss::test::fault, gliss::test::real;

// A function that gives its error.
#define FAULTY(name, parameters, arguments)                                \
  cl_int name parameters {                                                 \
    if (const cl_int code = fault(#name); code != CL_SUCCESS) return code; \
    static const auto next = real(&name, #name);                           \
    return next arguments;                                                 \
  }
// A function that gives an object, and its error where `error` points.
#define FAULTY_MAKER(type, name, parameters, arguments)         \
  type name parameters {                                        \
    if (const cl_int code = fault(#name); code != CL_SUCCESS) { \
      if (error != nullptr) *error = code;                      \
      return nullptr;                                           \
    }                                                           \
    static const auto next = real(&name, #name);                \
    return next arguments;                                      \
  }

extern "C" {

FAULTY(clGetPlatformIDs, (cl_uint count, cl_platform_id* platforms, cl_uint* found),
       (count, platforms, found))
FAULTY(clGetPlatformInfo,
       (cl_platform_id platform, cl_platform_info what, size_t size, void* value, size_t* needed),
       (platform, what, size, value, needed))
FAULTY(clGetDeviceIDs,
       (cl_platform_id platform, cl_device_type type, cl_uint count, cl_device_id* devices,
        cl_uint* found),
       (platform, type, count, devices, found))
FAULTY(clRetainDevice, (cl_device_id device), (device))
FAULTY(clReleaseDevice, (cl_device_id device), (device))
FAULTY(clReleaseContext, (cl_context context), (context))
FAULTY_MAKER(cl_command_queue, clCreateCommandQueue,
             (cl_context context, cl_device_id device, cl_command_queue_properties properties,
              cl_int* error),
             (context, device, properties, error))
FAULTY(clReleaseCommandQueue, (cl_command_queue queue), (queue))
FAULTY(clGetProgramInfo,
       (cl_program program, cl_program_info what, size_t size, void* value, size_t* needed),
       (program, what, size, value, needed))
FAULTY(clGetProgramBuildInfo,
       (cl_program program, cl_device_id device, cl_program_build_info what, size_t size,
        void* value, size_t* needed),
       (program, device, what, size, value, needed))
FAULTY(clSetKernelArg, (cl_kernel kernel, cl_uint index, size_t size, const void* value),
       (kernel, index, size, value))
FAULTY(clReleaseKernel, (cl_kernel kernel), (kernel))
FAULTY_MAKER(cl_mem, clCreateBuffer,
             (cl_context context, cl_mem_flags flags, size_t size, void* host, cl_int* error),
             (context, flags, size, host, error))
FAULTY(clReleaseMemObject, (cl_mem memory), (memory))
FAULTY(clEnqueueNDRangeKernel,
       (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset,
        const size_t* global, const size_t* local, cl_uint count, const cl_event* after,
        cl_event* event),
       (queue, kernel, dimensions, offset, global, local, count, after, event))
FAULTY_MAKER(void*, clEnqueueMapBuffer,
             (cl_command_queue queue, cl_mem buffer, cl_bool blocking, cl_map_flags flags,
              size_t offset, size_t size, cl_uint count, const cl_event* after, cl_event* event,
              cl_int* error),
             (queue, buffer, blocking, flags, offset, size, count, after, event, error))
FAULTY(clEnqueueUnmapMemObject,
       (cl_command_queue queue, cl_mem memory, void* mapped, cl_uint count, const cl_event* after,
        cl_event* event),
       (queue, memory, mapped, count, after, event))
FAULTY(clEnqueueReadBuffer,
       (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
        void* to, cl_uint count, const cl_event* after, cl_event* event),
       (queue, buffer, blocking, offset, size, to, count, after, event))
FAULTY(clEnqueueWriteBuffer,
       (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t size,
        const void* from, cl_uint count, const cl_event* after, cl_event* event),
       (queue, buffer, blocking, offset, size, from, count, after, event))
FAULTY(clFlush, (cl_command_queue queue), (queue))
FAULTY(clFinish, (cl_command_queue queue), (queue))
FAULTY(clGetEventProfilingInfo,
       (cl_event event, cl_profiling_info what, size_t size, void* value, size_t* needed),
       (event, what, size, value, needed))
FAULTY(clReleaseEvent, (cl_event event), (event))

cl_context clCreateContext(const cl_context_properties* properties, cl_uint count,
                           const cl_device_id* devices,
                           void(CL_CALLBACK* notify)(const char*, const void*, size_t, void*),
                           void* data, cl_int* error) {
  const cl_int code = fault("clCreateContext");
  if (error != nullptr) *error = code;
  if (code != CL_SUCCESS) return nullptr;
  const std::lock_guard lock(builds().mutex);
  static const auto next = real(&clCreateContext, "clCreateContext");
  if (!builds().shared) return next(properties, count, devices, notify, data, error);
  cl_context& one = builds().context;
  if (one == nullptr) one = next(properties, count, devices, notify, data, error);
  if (one != nullptr) clRetainContext(one);
  return one;
}

cl_program clCreateProgramWithSource(cl_context context, cl_uint count, const char** strings,
                                     const size_t* lengths, cl_int* error) {
  const cl_int code = fault("clCreateProgramWithSource");
  if (error != nullptr) *error = code;
  if (code != CL_SUCCESS) return nullptr;
  static const auto next = real(&clCreateProgramWithSource, "clCreateProgramWithSource");
  const cl_program program = next(context, count, strings, lengths, error);
  std::string text;
  for (cl_uint i = 0; i < count; ++i)
    text += lengths != nullptr && lengths[i] > 0 ? std::string(strings[i], lengths[i]) : strings[i];
  const std::lock_guard lock(builds().mutex);
  builds().text[program] = text;
  builds().instead.erase(program);
  return program;
}

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices,
                      const char* options, void(CL_CALLBACK* notify)(cl_program, void*),
                      void* data) {
  if (const cl_int code = fault("clBuildProgram"); code != CL_SUCCESS) return code;
  std::this_thread::sleep_for(gliss::test::build_time());
  const std::lock_guard lock(builds().mutex);
  static const auto next = real(&clBuildProgram, "clBuildProgram");
  if (!builds().shared) return next(program, count, devices, options, notify, data);
  cl_program& built = builds().built[builds().text[program] + options];
  if (built == nullptr) {
    const cl_int code = next(program, count, devices, options, notify, data);
    if (code != CL_SUCCESS) return code;
    clRetainProgram(built = program);
  }
  builds().instead[program] = built;
  return CL_SUCCESS;
}

cl_kernel clCreateKernel(cl_program program, const char* name, cl_int* error) {
  const cl_int code = fault("clCreateKernel");
  if (error != nullptr) *error = code;
  if (code != CL_SUCCESS) return nullptr;
  static const auto next = real(&clCreateKernel, "clCreateKernel");
  const std::lock_guard lock(builds().mutex);
  const auto found = builds().instead.find(program);
  return next(found == builds().instead.end() ? program : found->second, name, error);
}

FAULTY(clReleaseProgram, (cl_program program), (program))

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t size, void* value,
                       size_t* needed) {
  if (const cl_int code = fault("clGetDeviceInfo"); code != CL_SUCCESS) return code;
  static const auto next = real(&clGetDeviceInfo, "clGetDeviceInfo");
  const cl_int code = next(device, what, size, value, needed);
  gliss::test::State& s = gliss::test::state();
  const std::lock_guard lock(s.mutex);
  const auto found = s.pretended.find(what);
  // Little-endian: the low bytes come first.
  if (code == CL_SUCCESS && value != nullptr && found != s.pretended.end())
    std::memcpy(value, &found->second, size < sizeof(cl_ulong) ? size : sizeof(cl_ulong));
  return code;
}

}  // extern "C"
