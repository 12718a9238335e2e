#!/usr/bin/env bash
# Builds all that Gliss has with clang, warnings as errors, to find what g++ alone takes or does not see, and runs the
# tests of the benchmarks: installs packages (as root or with sudo), and takes as long as tools/test.sh takes to build.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
cmake --preset clang -DGLISS_TESTS=ON -DGLISS_BENCH=ON -DGLISS_UNITY=ON
cmake --build --preset clang --parallel "$(nproc)"
exec ctest --test-dir build-clang --output-on-failure -R "^(bench|rivals)$"
