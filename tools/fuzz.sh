#!/usr/bin/env bash
# Looks for inputs that break the readers, the cache, scenes, devices' messages and the build of patches: installs
# packages (as root or with sudo), builds with clang's libFuzzer under ASan and UBSan, and runs each target.
# Usage: tools/fuzz.sh [SECONDS [TARGET...]]: 60 s each, all of tests/fuzz/fuzz_*.cpp, such as obj or surface.
# Inputs that break something stay in fuzz-findings/TARGET; then it ends with 1. Those of tests/fuzz/corpus are where
# it begins, and CI runs them; what else it meets is kept in build-fuzz/corpus for the next time.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" "${fuzz_packages[@]}"

seconds=${1:-60}
targets=("${@:2}")
if ((${#targets[@]} == 0)); then
  for source in tests/fuzz/fuzz_*.cpp; do
    name=${source##*/fuzz_}
    targets+=("${name%.cpp}")
  done
fi

cmake --preset fuzz
cmake --build --preset fuzz --parallel "$(nproc)" --target "${targets[@]/#/fuzz_}"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export TEST_TMPDIR=$scratch/ UBSAN_OPTIONS=print_stacktrace=1
broken=()
for target in "${targets[@]}"; do
  found=fuzz-findings/$target met=build-fuzz/corpus/$target
  mkdir -p "$found" "$met"
  echo "$target: $seconds s"
  # 25 s for an input or 2 GiB in all are findings too. Inputs of 4 KiB reach all there is.
  if ! build-fuzz/tests/fuzz/"fuzz_$target" -max_total_time="$seconds" -max_len=4096 -timeout=25 -rss_limit_mb=2048 \
      -print_final_stats=1 -artifact_prefix="$found/" "$met" "tests/fuzz/corpus/$target" >"$scratch/log" 2>&1; then
    tail -n 60 "$scratch/log" >&2
    broken+=("$target")
  else
    grep -E '^#[0-9]+.*DONE|executed_units|new_units' "$scratch/log"
  fi
done
((${#broken[@]})) || exit 0
echo "Broken: ${broken[*]}. To see one again:" >&2
for target in "${broken[@]}"; do
  for input in fuzz-findings/"$target"/*; do
    echo "  build-fuzz/tests/fuzz/fuzz_$target $input" >&2
  done
done
exit 1
