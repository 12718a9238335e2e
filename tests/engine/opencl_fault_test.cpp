// OpenCL at fault: every call that can fail fails once, at every place where it is called. Then
// there is one line that says so, or the same bytes from oneTBB and one line.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <set>

#include "gliss/build/build_cache.h"
#include "gliss/engine/opencl.h"
#include "gliss/files/mesh_file.h"
#include "gliss/generate/generate.h"
#include "tests/engine/opencl_fault.h"
#include "tests/support/bytes.h"
#include "tests/support/gliss_process.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr char kGoingOn[] = "; going on with oneTBB";

// Why there is no device to be had, "" where there is one.
std::string no_device() {
  return test::message_of<DeviceError>([] { opencl_devices(); });
}

bool is_one_line(const std::string& text) {
  return !text.empty() && text.find_first_of("\n\r") == text.npos;
}

struct Outcome {
  std::string problem;               // one that was thrown
  std::string bytes;                 // else the result
  std::vector<std::string> notices;  // less that kernels are compiled
  bool failed = false;               // the call that was to fail came
};

// A call that fails, and what the line says then.
// `harmless`: calls whose failure comes to light elsewhere or does no harm, such as those of
// destructors after the results are there.
struct Call {
  const char* function;
  cl_int code;
  const char* reason;
  bool harmless = false;
};

class OpenClFault : public ::testing::TestWithParam<Precision> {
 protected:
  void SetUp() override {
    test::fail_call(nullptr);
    test::pretend_nothing();
    test::share_builds();  // of hundreds of engines
    if (const std::string why = no_device(); !why.empty()) GLISS_SKIP_UNLESS_REQUIRED(why);
    const std::vector<OpenClDevice> devices = opencl_devices();
    if (GetParam() == Precision::kDouble && !devices.front().fp64)
      GTEST_SKIP() << "skipped: " << devices.front().name << " has no fp64";
    const Mesh mesh = torus_knot(24, 6).mesh;
    BuildOptions build;
    build.precision = GetParam();
    build.level.construction = Construction::kPaper;  // by both kernels: fair quads come drafted
    cache_ = build_cache(mesh, build);
    // Pieces for both queues: see options_for_sweeps().
    SweepOptions sweep;
    sweep.depths = {1e-3};
    sweep.methods = {Method::kFlat};
    sweep.rings = rings_for(cache_, 8000);
    sweeps_.run = [=, this](const Engine& engine) { return test::swept(cache_, engine, sweep); };
    // Room for pieces of some 2,200 points.
    sweeps_.options.memory = cache_.bytes() + 2 * 2200 * 704;
    // Builds take these faces at once, with the same calls each time: how many they take after
    // so many is for the clock to say.
    builds_.run = [build, few = torus_knot(10, 6).mesh](const Engine& engine) {
      return test::bytes_of(engine.build(few, build));
    };
    builds_.options.smallest_batch = 1;
    for (Work* work : {&sweeps_, &builds_}) {
      work->options.threads = 2;
      work->options.device = "0";
      work->want = work->run(*make_tbb_engine(2));
    }
  }
  void TearDown() override {
    test::fail_call(nullptr);
    test::pretend_nothing();
    test::slow_builds(0);
  }

  // Something to do on an engine, and what comes of it.
  struct Work {
    OpenClOptions options;
    std::function<std::string(const Engine&)> run;
    std::string want;
  };

  static Outcome outcome_of(const Work& work, bool fall_back = false) {
    Outcome outcome;
    OpenClOptions options = work.options;
    options.fall_back = fall_back;
    options.notice = [&](const std::string& line) {
      if (line.find("compiling") == line.npos) outcome.notices.push_back(line);
    };
    try {
      outcome.bytes = work.run(*make_opencl_engine(options));
    } catch (const DeviceError& e) {
      outcome.problem = e.what();
    }
    outcome.failed = test::call_failed();
    return outcome;
  }

  static void expect_refused(const Work& work, const std::string& reason) {
    const Outcome refused = outcome_of(work);
    EXPECT_THAT(refused.problem, AllOf(StartsWith("opencl: "), HasSubstr(reason)));
    EXPECT_TRUE(is_one_line(refused.problem)) << refused.problem;
    EXPECT_TRUE(refused.notices.empty()) << refused.notices.front();
  }

  static void expect_taken_over(const Work& work, const std::string& reason) {
    const Outcome done = outcome_of(work, true);
    EXPECT_EQ(done.problem, "");
    EXPECT_TRUE(done.bytes == work.want);
    ASSERT_EQ(done.notices.size(), 1u);
    EXPECT_THAT(done.notices[0],
                AllOf(StartsWith("opencl: "), HasSubstr(reason), EndsWith(kGoingOn)));
    EXPECT_TRUE(is_one_line(done.notices[0])) << done.notices[0];
  }

  // Lets the work's calls of a function fail, one in turn, until they are through. How many there
  // are, and how many of them did no harm.
  static std::pair<int, int> expect_each_handled(const Work& work, const Call& call);
  // ... of all functions but those that it does not call; `shared`: memory is mapped, not copied.
  void expect_all_handled(const Work& work, const std::string& name, bool shared,
                          std::set<std::string> uncalled) const;

  PatchCache cache_;
  Work sweeps_, builds_;
};

const Call kCalls[] = {
    {"clGetPlatformIDs", -6, "(-6)"},
    {"clGetPlatformIDs", -1001, "no platform (-1001)"},
    {"clGetPlatformInfo", -6, "(-6)"},
    {"clGetDeviceIDs", -6, "(-6)"},
    {"clGetDeviceIDs", -1, "no device on platform"},
    {"clGetDeviceInfo", -5, "(-5)"},
    {"clCreateContext", -6, "clCreateContext failed: CL_OUT_OF_HOST_MEMORY (-6)"},
    {"clCreateProgramWithSource", -6, "clCreateProgramWithSource failed"},
    {"clBuildProgram", -11, "kernels do not compile: CL_BUILD_PROGRAM_FAILURE (-11)"},
    {"clBuildProgram", -6, "CL_OUT_OF_HOST_MEMORY (-6)"},
    {"clCreateKernel", -5, "clCreateKernel failed: CL_OUT_OF_RESOURCES (-5)"},
    {"clCreateCommandQueue", -6, "clCreateCommandQueue failed"},
    {"clCreateBuffer", -4, "clCreateBuffer failed: CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)"},
    {"clCreateBuffer", -61, "CL_INVALID_BUFFER_SIZE (-61)"},
    {"clSetKernelArg", -5, "clSetKernelArg failed"},
    {"clEnqueueWriteBuffer", -5, "clEnqueueWriteBuffer failed: CL_OUT_OF_RESOURCES (-5)"},
    {"clEnqueueReadBuffer", -5, "clEnqueueReadBuffer failed: CL_OUT_OF_RESOURCES (-5)"},
    {"clEnqueueMapBuffer", -12, "clEnqueueMapBuffer failed: CL_MAP_FAILURE (-12)"},
    {"clEnqueueUnmapMemObject", -5, "MapMemObject failed", true},
    {"clEnqueueNDRangeKernel", -5, "clEnqueueNDRangeKernel failed: CL_OUT_OF_RESOURCES (-5)"},
    {"clFlush", -5, "clFlush failed"},
    {"clFinish", -5, "clFinish failed: CL_OUT_OF_RESOURCES (-5)", true},
    {"clGetEventProfilingInfo", -7, "failed: error -7"},
    {"clRetainDevice", -6, "(-6)"},
    {"clReleaseDevice", -6, "", true},
    {"clReleaseContext", -6, "", true},
    {"clReleaseCommandQueue", -6, "", true},
    {"clReleaseProgram", -6, "", true},
    {"clReleaseKernel", -6, "", true},
    {"clReleaseMemObject", -6, "", true},
    {"clReleaseEvent", -6, "", true},
};

std::pair<int, int> OpenClFault::expect_each_handled(const Work& work, const Call& call) {
  int count = 0, harmless = 0;
  for (; !HasFailure(); ++count) {
    SCOPED_TRACE(fmt::format("{} gives {} at call {}", call.function, call.code, count + 1));
    test::fail_call(call.function, count + 1, call.code);
    const Outcome once = outcome_of(work);
    EXPECT_TRUE(once.notices.empty()) << once.notices.front();
    if (once.problem.empty()) {  // it did not come, or did no harm
      EXPECT_TRUE(once.bytes == work.want);
      if (!once.failed) break;
      EXPECT_TRUE(call.harmless) << "it passed unseen";
      ++harmless;
      continue;
    }
    EXPECT_TRUE(once.failed) << once.problem;
    EXPECT_THAT(once.problem, AllOf(StartsWith("opencl: "), HasSubstr(call.reason)));
    EXPECT_TRUE(is_one_line(once.problem)) << once.problem;
    test::fail_call(call.function, count + 1, call.code);
    expect_taken_over(work, call.reason);
  }
  return {count, harmless};
}

void OpenClFault::expect_all_handled(const Work& work, const std::string& name, bool shared,
                                     std::set<std::string> uncalled) const {
  test::pretend(CL_DEVICE_HOST_UNIFIED_MEMORY, shared);
  if (shared) uncalled.insert("clEnqueueReadBuffer");
  std::string places;
  for (const Call& call : kCalls) {
    const auto [count, harmless] = expect_each_handled(work, call);
    if (HasFailure()) return;
    EXPECT_EQ(count > 0, uncalled.count(call.function) == 0);
    places += fmt::format("{}{} {}", places.empty() ? "" : ", ", count, call.function);
    if (harmless > 0) places += fmt::format(" ({} harmless)", harmless);
  }
  test::record(name + (shared ? ", mapped" : ", copied"), "{}", places);
}

// Hundreds of engines each, so mapped in double and copied in float.
TEST_P(OpenClFault, of_any_call_of_a_sweep_is_one_line_or_left_to_the_host) {
  expect_all_handled(sweeps_, "sweep", GetParam() == Precision::kDouble, {});
}

// Builds are in double whatever comes of them.
TEST_P(OpenClFault, of_any_call_of_a_build_is_one_line_or_left_to_the_host) {
  if (!opencl_devices().front().fp64) GTEST_SKIP() << "skipped: there is no fp64";
  const bool mapped = GetParam() == Precision::kDouble;
  std::set<std::string> uncalled = {"clFlush"};
  if (mapped) uncalled.insert("clEnqueueWriteBuffer");  // which sweeps use for the patches
  expect_all_handled(builds_, "build", mapped, uncalled);
}

TEST_P(OpenClFault, of_a_buffer_too_large_names_both_sizes) {
  test::pretend(CL_DEVICE_MAX_MEM_ALLOC_SIZE, 4096);
  const std::string reason = "in one buffer, the device gives 0.003906 MiB";
  for (const Work& work : {sweeps_, builds_}) {
    expect_refused(work, reason);
    expect_taken_over(work, reason);
  }
}

TEST_P(OpenClFault, of_too_little_memory_names_both_sizes) {
  sweeps_.options.memory = builds_.options.memory = 65536;
  for (const auto& [work, reason] : {std::pair(&sweeps_, "the patches need "),
                                     std::pair(&builds_, "a batch of patches needs ")}) {
    expect_refused(*work, reason);
    expect_taken_over(*work, reason);
  }
}

TEST_P(OpenClFault, of_memory_full_of_patches_is_found_when_points_come) {
  sweeps_.options.memory = test::surface_bytes(cache_);
  expect_refused(sweeps_, "full of patches");
  expect_taken_over(sweeps_, "full of patches");
}

// No compiler can be stopped. It goes on alone, and the engine can be asked again.
TEST_P(OpenClFault, of_a_compiler_that_takes_long_is_not_waited_for) {
  struct Stop {};
  const std::chrono::seconds long_time(3);
  test::slow_builds(static_cast<double>(long_time.count()));
  std::atomic<bool> compiles = false;
  sweeps_.options.notice = [&](const std::string&) { compiles = true; };
  sweeps_.options.poll = [&] {
    if (compiles) throw Stop();
  };
  const auto engine = make_opencl_engine(sweeps_.options);
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_THROW(sweeps_.run(*engine), Stop);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, long_time);
  test::slow_builds(0);
  compiles = false;
  EXPECT_TRUE(sweeps_.run(*engine) == sweeps_.want);
}

INSTANTIATE_TEST_SUITE_P(Precisions, OpenClFault,
                         ::testing::Values(Precision::kDouble, Precision::kFloat),
                         [](const auto& info) {
                           return info.param == Precision::kFloat ? "float" : "double";
                         });

TEST(OpenClWithoutFp64, RefusesDoublesAndComputesInFloat) {
  if (const std::string why = no_device(); !why.empty()) GLISS_SKIP_UNLESS_REQUIRED(why);
  test::pretend(CL_DEVICE_DOUBLE_FP_CONFIG, 0);
  OpenClOptions options;
  options.device = "0";
  const auto engine = make_opencl_engine(options);
  const Mesh mesh = goldberg(2).mesh;
  const PatchCache doubles = test::cache_of(mesh);
  EXPECT_THAT(test::message_of<DeviceError>([&] { engine->reside(doubles); }),
              HasSubstr("has no fp64; take --precision float"));
  const PatchCache cache = test::cache_of(mesh, Precision::kFloat);
  EXPECT_NE(engine->reside(cache), nullptr);
  test::pretend_nothing();
}

// The program: exit codes, lines and files.
class OpenClProgram : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = no_device(); !why.empty()) GLISS_SKIP_UNLESS_REQUIRED(why);
    save_obj(torus_knot(24, 6).mesh, folder_ / "knot.obj");
    ASSERT_EQ(run("", "--backend tbb").code, 0);
    want_ = folder_.read("out.csv");
    ASSERT_GT(want_.size(), 1000000u);
    std::filesystem::remove(folder_ / "out.csv");
    files_ = folder_.file_count();
  }

  struct Outcome {
    int code;
    std::string err;
  };

  // A sweep with an environment of its own.
  Outcome run(const std::string& environment, const std::string& words) const {
    const std::string command = fmt::format(
        "cd '{}' && env {} '{}' sweep knot.obj --unit mm --depth 2mm --samples 2e4 --method flat "
        "-o out.csv {} >/dev/null 2>{} </dev/null",
        folder_ / "", environment, test::kProgram, words, err_ / "err");
    const int status = std::system(command.c_str());
    std::string err, all = err_.read("err");
    std::istringstream lines(all);
    for (std::string line; std::getline(lines, line);)
      if (line.find("compiling kernels, once") == line.npos && !line.starts_with("sweep: ") &&
          !line.starts_with("build: "))
        err += line + "\n";
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, err};
  }

  void expect_handled(const std::string& environment, const std::string& words,
                      const std::string& reason) const {
    SCOPED_TRACE(environment + " " + words);
    const auto one_line = [&](const std::string& end) {
      return AllOf(StartsWith("gliss: opencl: "), HasSubstr(reason), EndsWith(end + "\n"));
    };
    const Outcome refused = run(environment, words + " --backend opencl");
    EXPECT_EQ(refused.code, 4);
    EXPECT_THAT(refused.err, one_line(""));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_EQ(folder_.file_count(), files_) << "something is left";
    // A device by name: without, auto takes GPUs only.
    const std::string device =
        words.find("--opencl-device ") == words.npos ? " --opencl-device pthread" : "";
    const Outcome done = run(environment, words + device + " --backend auto");
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.err, one_line(kGoingOn));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_TRUE(folder_.read("out.csv") == want_);
    std::filesystem::remove(folder_ / "out.csv");
    EXPECT_EQ(folder_.file_count(), files_);
  }

  // A call of the program's that fails.
  void expect_call_handled(const std::string& function, int at, int code,
                           const std::string& reason) const {
    expect_handled(fmt::format("LD_PRELOAD={} GLISS_TEST_FAULT={}:{}:{}", test::kOpenClFault,
                               function, at, code),
                   "", reason);
  }
  bool on_pocl() const {
    return opencl_devices().front().platform == "Portable Computing Language";
  }

  const test::ScratchFolder folder_, err_;
  std::string want_;
  std::size_t files_ = 0;
};

TEST_F(OpenClProgram, GoesOnWithoutPlatform) {
  expect_handled("OCL_ICD_VENDORS=/nonexistent", "", "no platform (-1001)");
}

TEST_F(OpenClProgram, GoesOnWithoutDevice) {
  if (!on_pocl()) GTEST_SKIP() << "skipped: the device is not PoCL's";
  expect_handled("POCL_DEVICES=none", "", "no ");
  expect_call_handled("clGetDeviceIDs", 1, -1, "no device on platform");
}

TEST_F(OpenClProgram, NamesTheCacheThatPoclCannotWrite) {
  if (!on_pocl()) GTEST_SKIP() << "skipped: the device is not PoCL's";
  expect_handled("POCL_CACHE_DIR=/dev/null/cache", "", "/dev/null/cache");
}

TEST_F(OpenClProgram, NamesTheDevicesThatThereAre) {
  expect_handled("", "--opencl-device abacus",
                 "no device 'abacus'; there is " + opencl_devices().front().name);
}

TEST_F(OpenClProgram, GoesOnWhenCallsFail) {
  if (!on_pocl()) GTEST_SKIP() << "skipped: the device is not PoCL's";
  expect_call_handled("clCreateContext", 1, -6, "clCreateContext failed");
  expect_call_handled("clBuildProgram", 1, -11, "kernels do not compile");
  expect_call_handled("clCreateCommandQueue", 2, -6, "clCreateCommandQueue failed");
  expect_call_handled("clCreateBuffer", 14, -4, "clCreateBuffer failed");
  expect_call_handled("clEnqueueNDRangeKernel", 3, -5, "clEnqueueNDRangeKernel failed");
  expect_call_handled("clEnqueueMapBuffer", 4, -12, "CL_MAP_FAILURE (-12)");
  expect_call_handled("clFinish", 2, -5, "clFinish failed");
}

TEST_F(OpenClProgram, GoesOnWhenMemoryIsTooSmall) {
  if (!on_pocl()) GTEST_SKIP() << "skipped: the device is not PoCL's";
  // CL_DEVICE_MAX_MEM_ALLOC_SIZE
  expect_handled(fmt::format("LD_PRELOAD={} GLISS_TEST_DEVICE=0x1010:4096", test::kOpenClFault), "",
                 "CL_INVALID_BUFFER_SIZE (-61)");
}

TEST_F(OpenClProgram, KeepsToTheMemoryItIsGiven) {
  save_obj(torus_knot(120, 12).mesh, folder_ / "knot.obj");
  const Outcome refused = run("", "--backend opencl --device-memory 1");
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.err, HasSubstr(" MiB, to be used are 1 MiB\n"));
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  EXPECT_EQ(folder_.file_count(), files_) << "something is left";
}

TEST_F(OpenClProgram, StopsWhileKernelsAreCompiled) {
  test::Process sweep(folder_ / "", test::kProgram,
                      {"sweep", "knot.obj", "--unit", "mm", "--depth", "2mm", "--samples", "2e4",
                       "--method", "flat", "-o", "out.csv", "--backend", "opencl"},
                      [] {
                        return setenv("LD_PRELOAD", test::kOpenClFault, 1) == 0 &&
                               setenv("GLISS_TEST_SLOW_BUILD", "30", 1) == 0;
                      });
  EXPECT_TRUE(test::await(
      [&] { return sweep.err().find("compiling kernels, once") != std::string::npos; }));
  const auto begin = std::chrono::steady_clock::now();
  sweep.kill(SIGINT);
  const test::Outcome outcome = sweep.wait();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
  EXPECT_EQ(outcome.code, 130);
  EXPECT_THAT(outcome.err, EndsWith("gliss: interrupted\n"));
  EXPECT_EQ(folder_.file_count(), files_);
}

// auto without a name takes GPUs; there is a line where it finds none.
TEST_F(OpenClProgram, SaysThatThereIsNoGpu) {
  for (const OpenClDevice& device : opencl_devices())
    if (device.type == "GPU") GTEST_SKIP() << "skipped: there is a GPU";
  const Outcome done = run("", "--backend auto");
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, AllOf(StartsWith("gliss: opencl: no GPU; there is "),
                              EndsWith(std::string(kGoingOn) + "\n")));
  EXPECT_TRUE(folder_.read("out.csv") == want_);
}

}  // namespace
}  // namespace gliss
