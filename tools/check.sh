#!/usr/bin/env bash
# Checks what needs no build, in a minute: formatting, that rooms see only what they may, that pages name what is there
# and their programs compile, and the kernels as OpenCL C. The first of what CI runs. Installs packages (as root or
# with sudo).
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
if command -v apt-get >/dev/null; then export GLISS_REQUIRE=1; fi

# Another release formats in another way.
find kernels host runtime python tools tests bench examples -name '*.h' -o -name '*.cpp' -o -name '*.inc' | sort |
  xargs clang-format-14 --dry-run -Werror
cmake --preset release -DGLISS_TESTS=ON -DGLISS_BENCH=ON -DGLISS_UNITY=ON
exec ctest --preset release -R '^(rooms|pages|kernels_as_opencl|narrowing_flags)$'
