#!/usr/bin/env bash
# Measures Gliss beside peers and the machine's limits, and writes the section of bench/LOG.md between its two
# markers. No figure fails it. Takes a quarter of an hour; --quick is for trying it: a short run, printed only.
# Further arguments go to gliss_bench: tools/bench.sh --size=100000
# How often the force jumps on random walks is measured by bench/walks.py, over the meshes of a folder.
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}" libbenchmark-dev
install_packages "${bench_packages[@]}" || echo "Without all of ${bench_packages[*]}: their peers are left out" >&2

quick=
if [[ ${1-} == --quick ]]; then
  quick=1
  shift
fi
cmake --preset release -DGLISS_BENCH=ON
cmake --build --preset release --parallel "$(nproc)" --target gliss_bench

run=(--benchmark_filter='^(machine|peer|api|evaluate|build|nearest|track|tick|sweep|load).*/[0-9]+$'
  --benchmark_repetitions=5 --benchmark_min_time=0.2)
[[ -z $quick ]] || run+=(--benchmark_repetitions=1 --benchmark_min_time=0.01)
results=$(mktemp)
trap 'rm -f "$results"' EXIT
build/gliss_bench "${run[@]}" --benchmark_out="$results" --benchmark_out_format=json "$@"
if [[ -n $quick ]]; then
  python3 tools/bench_table.py "$results"
else
  python3 tools/bench_table.py "$results" bench/LOG.md
  echo "Written: bench/LOG.md"
fi
