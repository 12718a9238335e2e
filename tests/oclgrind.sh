#!/bin/sh
# The kernels under Oclgrind: no access out of bounds, no race, nothing read before it is written,
# no wrong call; and the host's results. usage: oclgrind.sh TESTS, the program of the tests. Exit
# code 77: Oclgrind is absent.
set -eu
tests=$1
. "$(dirname "$0")/support/skip.sh"
library=
for candidate in /usr/lib/oclgrind /usr/lib/*/oclgrind /usr/local/lib /usr/local/lib/oclgrind; do
  [ -e "$candidate/liboclgrind-rt-icd.so" ] && library=$candidate/liboclgrind-rt-icd.so && break
done
[ -n "$library" ] || skip_unless_required "oclgrind is absent"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# As a driver among others, the only one: the tests' own functions stay before it.
mkdir "$scratch/drivers"
echo "$library" >"$scratch/drivers/oclgrind.icd"
export OCL_ICD_VENDORS="$scratch/drivers"
export OCLGRIND_CHECK_API=1 OCLGRIND_DATA_RACES=1 OCLGRIND_UNINITIALIZED=1
# What the optimiser makes, Oclgrind 21.10 does not know (llvm.experimental.noalias.scope.decl).
export OCLGRIND_BUILD_OPTIONS="-cl-opt-disable -DGLISS_INLINE="
export OCLGRIND_LOG="$scratch/log"
status=0
# A HIP takes a second. Cutting takes hundreds, and no kernel of its own.
GLISS_TEST_QUESTIONS=3 "$tests" --gtest_filter='*/OpenClSmall.*:-*cuts*' >"$scratch/output" 2>&1 || status=$?
cat "$scratch/output"
if grep -q 'SKIPPED' "$scratch/output"; then
  echo "a test was skipped" >&2
  exit 1
fi
if [ -s "$scratch/log" ]; then
  echo "oclgrind found:" >&2
  head -n 60 "$scratch/log" >&2
  exit 1
fi
exit $status
