#!/usr/bin/env bash
# What CI runs: installs packages (as root or with sudo), checks the formatting, builds everything with warnings
# as errors, runs the tests. Arguments go to ctest: tools/test.sh -R Sweep
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
install_packages "${optional_test_packages[@]}" ||
  echo "Without ${optional_test_packages[*]}: tests that need it will be skipped" >&2

# Another release formats in another way.
find kernels host runtime tools tests bench -name '*.h' -o -name '*.cpp' -o -name '*.inc' | sort |
  xargs clang-format-14 --dry-run -Werror

cores=$(nproc)
cmake --preset release -DGLISS_TESTS=ON -DGLISS_BENCH=ON
cmake --build --preset release --parallel "$cores"
exec ctest --preset release --parallel "$cores" "$@"
