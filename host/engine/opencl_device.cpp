#include "gliss/engine/opencl_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace gliss {
namespace {

struct Found {
  cl::Device id;
  OpenClDevice info;
};

std::string error_name(cl_int code) {
  static const std::map<cl_int, const char*> names = {
      {CL_DEVICE_NOT_FOUND, "CL_DEVICE_NOT_FOUND"},
      {CL_DEVICE_NOT_AVAILABLE, "CL_DEVICE_NOT_AVAILABLE"},
      {CL_COMPILER_NOT_AVAILABLE, "CL_COMPILER_NOT_AVAILABLE"},
      {CL_MEM_OBJECT_ALLOCATION_FAILURE, "CL_MEM_OBJECT_ALLOCATION_FAILURE"},
      {CL_OUT_OF_RESOURCES, "CL_OUT_OF_RESOURCES"},
      {CL_OUT_OF_HOST_MEMORY, "CL_OUT_OF_HOST_MEMORY"},
      {CL_BUILD_PROGRAM_FAILURE, "CL_BUILD_PROGRAM_FAILURE"},
      {CL_MAP_FAILURE, "CL_MAP_FAILURE"},
      {CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST,
       "CL_EXEC_STATUS_ERROR_FOR_EVENTS_IN_WAIT_LIST"},
      {CL_INVALID_COMMAND_QUEUE, "CL_INVALID_COMMAND_QUEUE"},
      {CL_INVALID_BUFFER_SIZE, "CL_INVALID_BUFFER_SIZE"},
      {CL_INVALID_WORK_GROUP_SIZE, "CL_INVALID_WORK_GROUP_SIZE"},
      {-1001, "CL_PLATFORM_NOT_FOUND_KHR"},
      {-9999, "a kernel went out of bounds, NVIDIA's driver says"}};
  const auto found = names.find(code);
  return found == names.end() ? fmt::format("error {}", code)
                              : fmt::format("{} ({})", found->second, code);
}

// Drivers pad their strings.
std::string trimmed(std::string text) {
  while (!text.empty() &&
         (text.back() == '\0' || std::isspace(static_cast<unsigned char>(text.back()))))
    text.pop_back();
  return text;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// Vector widths of OpenCL C up to what the device computes with at once.
int lanes_for(cl_uint native) { return native >= 16 ? 16 : native >= 8 ? 8 : native >= 4 ? 4 : 1; }

OpenClDevice describe(const cl::Device& id, const std::string& platform) {
  OpenClDevice d;
  d.platform = platform;
  d.name = trimmed(id.getInfo<CL_DEVICE_NAME>());
  d.driver = trimmed(id.getInfo<CL_DRIVER_VERSION>());
  d.language = trimmed(id.getInfo<CL_DEVICE_OPENCL_C_VERSION>());
  const auto type = id.getInfo<CL_DEVICE_TYPE>();
  d.type = type & CL_DEVICE_TYPE_GPU ? "GPU" : type & CL_DEVICE_TYPE_CPU ? "CPU" : "accelerator";
  d.fp64 = id.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0;
  d.exact = (id.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
  d.shares_memory = id.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() != 0;
  d.memory = id.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  d.largest_buffer = id.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  d.units = id.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  d.lanes_float = lanes_for(id.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>());
  d.lanes_double = lanes_for(id.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_DOUBLE>());
  return d;
}

// PoCL keeps what it compiles; where it cannot, it shows no device.
std::string unwritable_cache() {
  namespace fs = std::filesystem;
  const char *own = std::getenv("POCL_CACHE_DIR"), *xdg = std::getenv("XDG_CACHE_HOME"),
             *home = std::getenv("HOME");
  const fs::path folder = own    ? fs::path(own)
                          : xdg  ? fs::path(xdg) / "pocl"
                          : home ? fs::path(home) / ".cache/pocl"
                                 : fs::path("/tmp/pocl");
  std::error_code code;
  fs::create_directories(folder, code);
  const fs::path probe = folder / fmt::format("gliss.{}", ::getpid());
  std::FILE* file = std::fopen(probe.c_str(), "w");
  if (file == nullptr) return folder.string();
  std::fclose(file);
  fs::remove(probe, code);
  return {};
}

std::vector<Found> find_devices() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error& e) {
    if (e.err() != -1001)
      throw DeviceError(fmt::format("opencl: {} failed: {}", e.what(), error_name(e.err())));
  }
  if (platforms.empty()) {
    throw DeviceError(
        "opencl: no platform (-1001): no driver is installed, such as Debian's pocl-opencl-icd");
  }
  std::vector<Found> found;
  std::string names, problem;  // of a platform that fails: the others may do
  for (const cl::Platform& platform : platforms) {
    std::string name = fmt::format("platform {}", &platform - platforms.data());
    try {
      name = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
      names += (names.empty() ? "" : ", ") + name;
      std::vector<cl::Device> devices;
      platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
      for (const cl::Device& device : devices) found.push_back({device, describe(device, name)});
    } catch (const cl::Error& e) {
      if (e.err() != CL_DEVICE_NOT_FOUND)
        problem = fmt::format("opencl: {}: {} failed: {}", name, e.what(), error_name(e.err()));
    }
  }
  if (!found.empty()) return found;
  if (!problem.empty()) throw DeviceError(problem);
  const bool pocl = names.find("Portable Computing Language") != names.npos;
  const std::string folder = pocl ? unwritable_cache() : "";
  problem = "opencl: no device on platform " + names;
  if (!folder.empty()) problem += "; PoCL shows none where it cannot write its cache: " + folder;
  throw DeviceError(problem);
}

Found choose(const std::string& wish, bool only_gpu) {
  std::vector<Found> all = find_devices();
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const OpenClDevice& d = all[i].info;
    if (wish.empty() ? d.type == "GPU"
                     : wish == std::to_string(i) || lower(d.name).find(lower(wish)) != wish.npos ||
                           lower(d.platform).find(lower(wish)) != wish.npos)
      return std::move(all[i]);
    names += fmt::format("{}{}", names.empty() ? "" : ", ", d.name);
  }
  if (wish.empty() && !only_gpu) return std::move(all.front());
  throw DeviceError(fmt::format("opencl: no {}; there is {}",
                                wish.empty() ? "GPU" : fmt::format("device '{}'", wish), names));
}

// The first error of a compiler's log, or its first line.
std::string first_error(const std::string& log) {
  std::size_t at = log.find("error");
  at = at == log.npos ? 0 : log.rfind('\n', at) + 1;
  return trimmed(log.substr(at, log.find('\n', at) - at));
}

std::string size_text(std::uint64_t bytes) {
  return fmt::format("{:.4g} MiB", static_cast<double>(bytes) / (1 << 20));
}

}  // namespace

std::vector<OpenClDevice> opencl_devices() {
  std::vector<OpenClDevice> infos;
  for (const Found& found : find_devices()) infos.push_back(found.info);
  return infos;
}

Device::Device(const OpenClOptions& options) : notice_(options.notice), poll_(options.poll) {
  Found found = choose(options.device, options.fall_back);
  info_ = std::move(found.info);
  id_ = std::move(found.id);
  memory_ = options.memory > 0 ? options.memory : info_.memory / 2;
  try {
    context_ = cl::Context(id_);
  } catch (const cl::Error& e) {
    throw error(e);
  }
}

DeviceError Device::error(const cl::Error& e) const {
  return error(fmt::format("{} failed: {}", e.what(), error_name(e.err())));
}

DeviceError Device::error(const std::string& problem) const {
  return DeviceError(fmt::format("opencl: {}: {}", info_.name, problem));
}

void Device::require(Precision precision) const {
  if (precision == Precision::kDouble && !info_.fp64)
    throw error("has no fp64; take --precision float");
}

void Device::require_room(std::uint64_t bytes, const std::string& who) const {
  if (bytes > memory_)
    throw error(fmt::format("{} {}, to be used are {}", who, size_text(bytes), size_text(memory_)));
}

cl::Kernel Device::kernel(const char* program, const char* name,
                          const ProgramVariant& variant) const {
  const std::lock_guard lock(mutex_);
  const auto key = std::make_pair(program, variant);
  auto found = programs_.find(key);
  if (found == programs_.end()) found = programs_.emplace(key, compile(program, variant)).first;
  return cl::Kernel(found->second, name);
}

void Device::await_compiler(const std::future<void>& done) const {
  constexpr int kSteps = 3;  // until it takes long
  for (int step = 1; done.wait_for(std::chrono::milliseconds(100)) != std::future_status::ready;
       ++step) {
    if (step == kSteps && notice_ && !noticed_.exchange(true))
      notice_(fmt::format("opencl: {}: compiling kernels, once", info_.name));
    poll_();
  }
}

// Without a poll the caller's own thread works: Oclgrind crashes where another one compiles.
void Device::patiently(std::function<void()> work) const {
  std::packaged_task<void()> task(std::move(work));
  std::future<void> done = task.get_future();
  if (poll_) {
    std::thread(std::move(task)).detach();
    await_compiler(done);
  } else {
    const auto watching = std::async(std::launch::async, [&] { await_compiler(done); });
    task();
  }
  done.get();
}

cl::Program Device::compile(const char* text, const ProgramVariant& variant) const {
  const std::string options = fmt::format(
      "-w -cl-std=CL1.2 {}-DGLISS_SCALAR={} -DGLISS_LANES={} -DGLISS_FORMS={}u "
      "-DGLISS_VALENCES={}u -DGLISS_GROUP={}",
      info_.exact ? "-cl-fp32-correctly-rounded-divide-sqrt " : "",
      variant.precision == Precision::kFloat ? "float" : "double", variant.lanes,
      variant.kinds.forms, variant.kinds.valences, kGroup);
  const cl::Program program(context_, std::string(text));
  const auto code = std::make_shared<cl_int>(CL_SUCCESS);
  patiently([=, device = id_()] {
    // By the C call: the C++ one throws what the log's absence is called instead.
    *code = clBuildProgram(program(), 1, &device, options.c_str(), nullptr, nullptr);
  });
  if (*code == CL_SUCCESS) return program;
  std::string log;
  try {
    log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(id_);
  } catch (const cl::Error&) {  // some keep none
  }
  throw error(fmt::format("kernels do not compile: {}: {}", error_name(*code),
                          log.empty() ? "no log" : first_error(log)));
}

cl::Buffer Device::buffer(std::size_t bytes, cl_mem_flags flags, const std::string& what) const {
  if (bytes > info_.largest_buffer) {
    throw error(fmt::format("{} need {} in one buffer, the device gives {} ({})", what,
                            size_text(bytes), size_text(info_.largest_buffer),
                            error_name(CL_INVALID_BUFFER_SIZE)));
  }
  try {
    return cl::Buffer(context_, flags, std::max<std::size_t>(bytes, 1));
  } catch (const cl::Error& e) {
    throw error(fmt::format("{} need {}: {} failed: {}", what, size_text(bytes), e.what(),
                            error_name(e.err())));
  }
}

}  // namespace gliss
