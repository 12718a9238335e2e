#!/usr/bin/env bash
# The loop's wakes beside those of cyclictest (rt-tests), turn by turn, for the machine may have other guests: p99 of both,
# their ratio, and its median. Usage: cyclictest.sh [GLISS [TURNS]]
set -euo pipefail
gliss=${1:-build/gliss} turns=${2:-8}
seconds=2
if ! cyclictest --quiet --mlockall --priority=80 --interval=1000 --loops=10 >/dev/null 2>&1; then
  echo "cyclictest (rt-tests) is not here, or may not use SCHED_FIFO" >&2
  exit 4
fi

# Microseconds that 99 % of the wakes were not later than.
cyclictest_p99() {
  cyclictest --quiet --mlockall --priority=80 --interval=1000 --duration=$seconds --histogram=50000 |
    awk '/^[0-9]/ { count[$1 + 0] = $2; total += $2 }
         END { for (us = 0; us < 50000; ++us) { seen += count[us]; if (seen >= 0.99 * total) { print us + 1; exit } } print 50000 }'
}

for ((turn = 1; turn <= turns; ++turn)); do
  theirs=$(cyclictest_p99)
  ours=$("$gliss" judge --seconds $((2 * seconds)) --json --quiet |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["wake"]["p99_us"])')
  awk -v ours="$ours" -v theirs="$theirs" \
    'BEGIN { printf "p99 of the wakes: the loop %.1f us, cyclictest %.1f us, ratio %.2f\n", ours, theirs, ours / theirs }'
done | tee /dev/stderr | awk '{ print $NF }' | sort -n |
  awk '{ ratio[NR] = $1 } END { printf "median of the ratios %.2f (goal: at most 2)\n", ratio[int((NR + 1) / 2)] }'
