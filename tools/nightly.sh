#!/usr/bin/env bash
# Runs what takes too long for CI, for a night: sanitizers, another compiler, each part left out in turn, inputs that
# may break something, faults that the tests must notice, the worst value of every bound, the Python package from its
# source distribution alone. Goes on where one fails, and ends with 1 then; each says more.
set -uo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
failed=()
for script in sanitize clang options fuzz mutate extremes; do
  bash "tools/$script.sh" || failed+=("tools/$script.sh")
done
GLISS_LONG_TESTS=1 bash tools/test.sh -R python_sdist || failed+=("the package from its source distribution")
if ((${#failed[@]} > 0)); then
  echo "failed: ${failed[*]}" >&2
  exit 1
fi
