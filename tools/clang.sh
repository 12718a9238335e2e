#!/usr/bin/env bash
# Builds all that Gliss has with clang, warnings as errors, to find what g++ alone takes or does not see: installs
# packages (as root or with sudo), and takes as long as tools/test.sh takes to build. No test is run.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
cmake --preset clang -DGLISS_TESTS=ON -DGLISS_BENCH=ON -DGLISS_UNITY=ON
exec cmake --build --preset clang --parallel "$(nproc)"
