// Makes OpenCL fail, or say other things of itself, for the tests.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

namespace gliss::test {

// From now on the call number `at` (from 1) of an OpenCL function gives `code` and does nothing;
// null: none does.
void fail_call(const char* function, int at = 1, cl_int code = CL_OUT_OF_RESOURCES);
bool call_failed();  // that call came, and was made to fail

// From now on there is one context, and of programs of one text and the same options the first one
// alone is built: a build, even of what the driver remembers, takes it a tenth of a second.
void share_builds();

// From now on a program takes at least so long to build. As LD_PRELOAD: GLISS_TEST_SLOW_BUILD=5.
void slow_builds(double seconds);

// Sets what devices say of themselves from now on, whatever they are. Only numbers.
void pretend(cl_device_info what, cl_ulong value);
void pretend_nothing();

}  // namespace gliss::test
