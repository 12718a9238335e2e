#!/usr/bin/env bash
# Runs the tests that sanitizers are for (tests/sanitized.cmake): under ASan and UBSan with the corpora of the fuzz
# targets, and under TSan. Both are for a night, and for whoever changes what reads, writes or is shared by threads.
# Installs packages (as root or with sudo).
#
#   tools/sanitize.sh          both
#   tools/sanitize.sh tsan     one of asan, tsan
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
(($# > 0)) || set -- asan tsan
cores=$(nproc)
for sanitizers in "$@"; do
  cmake --preset "$sanitizers" -DGLISS_TESTS=ON -DGLISS_UNITY=ON
  cmake --build --preset "$sanitizers" --parallel "$cores"
  ctest --preset "$sanitizers" --parallel "$cores"
done
