#!/bin/sh
# Runs a program of sanitizers. Some kernels lay memory out as the sanitizers of an older compiler cannot take it: they
# are asked not to, and where that is refused the test is skipped, or fails if all is required.
set -eu
. "$(dirname "$0")/support/skip.sh"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
straight=
setarch -R true 2>/dev/null && straight="setarch -R"
status=0
$straight "$@" >"$log" 2>&1 || status=$?
cat "$log"
if [ $status != 0 ] && grep -qE "unexpected memory mapping|Shadow memory range interleaves" "$log"; then
  skip_unless_required "this kernel lays memory out as the sanitizers cannot take it"
fi
exit $status
