#!/usr/bin/env bash
# Measures the worst value of every bound and writes tests/EXTREMES.md. Takes some hours; GLISS_LONG_TESTS=20 takes
# twenty times the samples of CI instead, GLISS_LONG_TESTS= those of CI: minutes. Stopped, it keeps what it has measured.
# Usage: tools/extremes.sh [TESTS]: only those, such as 'ExtremeNearest*'; the other rows stay.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
cmake --preset release -DGLISS_TESTS=ON
cmake --build --preset release --parallel "$(nproc)"
rows=$(mktemp)
whole=
write_table() {
  python3 tools/extremes_table.py "$rows" tests/EXTREMES.md $whole
  rm -f "$rows"
  echo "Written: tests/EXTREMES.md"
}
trap write_table EXIT
export GLISS_EXTREMES=$rows GLISS_LONG_TESTS=${GLISS_LONG_TESTS-1}
[[ -n $GLISS_LONG_TESTS ]] || unset GLISS_LONG_TESTS
status=0
build/tests/gliss_tests --gtest_filter="${1-Extreme*}" || status=$?
(($# > 0 || status > 1)) || whole=--whole  # not where it was stopped
exit "$status"
