// Paths of what lies outside the tests' own folder. Named in one object only, so that the others
// are the same in every build tree.
#pragma once

namespace gliss::test {

extern const char* const kProgram;      // gliss
extern const char* const kMpiProgram;   // gliss-mpi, or "" where it is not built
extern const char* const kOpenClFault;  // the library of opencl_fault.h
extern const char* const kTests;        // the folder of the tests
extern const char* const kShared;       // folder of meshes and golden values, which may be absent

}  // namespace gliss::test
