#include "tests/support/places.h"

namespace gliss::test {

const char* const kProgram = GLISS_PROGRAM;
const char* const kMpiProgram = GLISS_MPI_PROGRAM;
const char* const kOpenClFault = GLISS_OPENCL_FAULT;
const char* const kTests = GLISS_TESTS_DIR;
const char* const kShared = GLISS_SHARED_DIR;

}  // namespace gliss::test
