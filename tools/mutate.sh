#!/usr/bin/env bash
# Do the tests notice faults? Gives each mutant of tests/mutants.txt to them. All are built at once, into a copy of the
# tree in build-mutants/; GLISS_MUTANT picks the one that a run has. Goes on where it was stopped: a mutant with a
# result in build-mutants/results.txt is not run again, unless it is named.
#
#   tools/mutate.sh               builds, and runs those that have no result
#   tools/mutate.sh NAME ...      runs these, whatever their results; without a build where there is one
#   tools/mutate.sh --table       writes tests/MUTANTS.md
#   tools/mutate.sh --tests FILE  prints the tests of a file such as kernels/track.h, for --gtest_filter
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
folder=build-mutants
if [[ ${1-} == --table ]]; then exec python3 tools/mutants.py table $folder >tests/MUTANTS.md; fi
if [[ ${1-} == --tests ]]; then exec python3 tools/mutants.py tests "${@:2}"; fi
if (($# == 0)) || [[ ! -x $folder/tree/build-dev/tests/gliss_tests ]]; then
  python3 tools/mutants.py apply $folder
  export CCACHE_SLOPPINESS=pch_defines,time_macros
  (cd $folder/tree && cmake --preset dev -DGLISS_TESTS=ON >/dev/null &&
    cmake --build --preset dev --parallel "$(nproc)" --target gliss_tests)
fi
exec python3 tools/mutants.py run $folder "$@"
