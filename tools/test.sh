#!/usr/bin/env bash
# What CI runs: installs packages (as root or with sudo), checks (tools/check.sh), builds everything but the benchmarks
# (tools/clang.sh, each night) with warnings as errors and runs all tests.
# What is installed here is tested: a skip for want of it is a failure (GLISS_REQUIRE).
# Arguments go to ctest, and only those tests run: tools/test.sh -R Sweep
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
install_packages "${optional_test_packages[@]}" ||
  echo "Without ${optional_test_packages[*]}: tests that need it will be skipped" >&2
if command -v apt-get >/dev/null; then export GLISS_REQUIRE=1; fi

# g++ is quicker by 6 % where it may fill 400 MB before it looks for what it no longer needs.
if [[ ${CXX:-g++} == *g++* && ${CXX-} != *clang* ]]; then export CXXFLAGS="${CXXFLAGS-} --param ggc-min-heapsize=400000"; fi

(($# > 0)) || bash tools/check.sh
cores=$(nproc)
cmake --preset release -DGLISS_TESTS=ON -DGLISS_BENCH=OFF -DGLISS_UNITY=ON
cmake --build --preset release --parallel "$cores"
exec ctest --preset release --parallel "$cores" "$@"
