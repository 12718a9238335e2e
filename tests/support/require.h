// Skips for want of what tools/test.sh installs, such as an OpenCL device or strace.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

namespace gliss::test {

// True if such a skip is a failure: GLISS_REQUIRE=1, which tools/test.sh sets.
inline bool all_is_required() {
  const char* text = std::getenv("GLISS_REQUIRE");
  return text != nullptr && std::strcmp(text, "1") == 0;
}

}  // namespace gliss::test

// Ends a test that cannot run here: it is skipped, or fails where all is required. Skips for want
// of ../shared, a GPU or a right are GTEST_SKIP.
#define GLISS_SKIP_UNLESS_REQUIRED(why)                                             \
  do {                                                                              \
    if (::gliss::test::all_is_required()) FAIL() << "GLISS_REQUIRE, but " << (why); \
    GTEST_SKIP() << "skipped: " << (why);                                           \
  } while (false)
