#!/usr/bin/env bash
# Runs what takes too long for CI, for a night: sanitizers, another compiler, each part left out in turn, inputs that
# may break something, faults that the tests must notice, the worst value of every bound. Goes on where one fails, and
# ends with 1 then; each says more.
set -uo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
failed=()
for script in sanitize clang options fuzz mutate extremes; do
  bash "tools/$script.sh" || failed+=("tools/$script.sh")
done
if ((${#failed[@]} > 0)); then
  echo "failed: ${failed[*]}" >&2
  exit 1
fi
