#!/usr/bin/env bash
# The loop's wakes beside those of cyclictest (rt-tests), turn by turn: p99 within twice, in the best of some tries, for
# the machine has other guests. Usage: cyclictest.sh GLISS
set -euo pipefail
gliss=$1
seconds=2 tries=8
if ! command -v cyclictest >/dev/null || ! cyclictest --quiet --mlockall --priority=80 --interval=1000 --loops=10 >/dev/null 2>&1; then
  echo "skipped: cyclictest is not here, or may not use SCHED_FIFO"
  exit 77
fi

# Microseconds that 99 % of the wakes were not later than.
cyclictest_p99() {
  cyclictest --quiet --mlockall --priority=80 --interval=1000 --duration=$seconds --histogram=50000 |
    awk '/^[0-9]/ { count[$1 + 0] = $2; total += $2 }
         END { for (us = 0; us < 50000; ++us) { seen += count[us]; if (seen >= 0.99 * total) { print us + 1; exit } } print 50000 }'
}

for ((try = 1; try <= tries; ++try)); do
  theirs=$(cyclictest_p99)
  ours=$("$gliss" judge --seconds $((2 * seconds)) --json --quiet |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["wake"]["p99_us"])')
  echo "try $try: p99 of the loop's wakes $ours us, of cyclictest's $theirs us"
  if python3 -c "import sys; sys.exit(not $ours <= 2 * $theirs)"; then exit 0; fi
done
echo "the loop wakes more than twice as late as cyclictest"
exit 1
