// Rates of the hot paths on generated meshes, beside those of peers that are installed and what the
// machine can do at most. Names: path/level/precision/n/backend/threads.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <optional>
#include <string>

#include "bench/benches.h"
#include "bench/meshes.h"

namespace {

// The value of --name=VALUE, which is taken out of the arguments.
std::optional<std::string> take_option(const std::string& name, int& argc, char** argv) {
  const std::string start = "--" + name + "=";
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]).rfind(start, 0) != 0) continue;
    const std::string value = argv[i] + start.size();
    std::rotate(argv + i, argv + i + 1, argv + argc);
    --argc;
    return value;
  }
  return std::nullopt;
}

}  // namespace

// --size=FACES: of the generated meshes, about. --device=NAME: part of the name of an OpenCL
// device, or its number.
int main(int argc, char** argv) {
  using namespace gliss::bench;
  if (const auto size = take_option("size", argc, argv)) {
    const auto [end, error] =
        std::from_chars(size->data(), size->data() + size->size(), mesh_faces);
    if (error != std::errc{} || end != size->data() + size->size() || mesh_faces < 100 ||
        mesh_faces > 100'000'000) {
      std::fprintf(stderr, "--size takes 100 to 100000000 faces\n");
      return 2;
    }
  }
  const std::string device = take_option("device", argc, argv).value_or("");
  register_machine();
  register_evaluate();
  register_build();
  register_queries();
  register_whole();
  register_peers();
  register_loop();
  register_opencl(device);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
