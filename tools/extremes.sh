#!/usr/bin/env bash
# Measures the worst value of every bound and writes tests/EXTREMES.md. Takes some hours; GLISS_LONG_TESTS=20 takes
# twenty times the samples of CI instead, GLISS_LONG_TESTS= those of CI: minutes.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${test_packages[@]}"
cmake --preset release -DGLISS_TESTS=ON
cmake --build --preset release --parallel "$(nproc)"
rows=$(mktemp)
trap 'rm -f "$rows"' EXIT
export GLISS_EXTREMES=$rows GLISS_LONG_TESTS=${GLISS_LONG_TESTS-1}
[[ -n $GLISS_LONG_TESTS ]] || unset GLISS_LONG_TESTS
status=0
build/tests/gliss_tests --gtest_filter='Extreme*' || status=$?
python3 tools/extremes_table.py "$rows" >tests/EXTREMES.md
echo "Written: tests/EXTREMES.md"
exit "$status"
