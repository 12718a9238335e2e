// The groups of benchmarks, each registered by its own file.
#pragma once

#include <string>

namespace gliss::bench {

void register_machine();  // what it can do at most
void register_evaluate();
void register_build();
void register_queries();  // nearest, track, tick
void register_whole();    // sweep, load
void register_peers();    // those that are installed
void register_loop();
// Registers the benchmarks of the OpenCL engine, each beside oneTBB's in the same run.
void register_opencl(const std::string& device);

}  // namespace gliss::bench
