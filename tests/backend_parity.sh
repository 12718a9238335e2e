#!/bin/sh
# Every backend, number of threads and instruction set sweeps the same bytes. usage:
# backend_parity.sh GLISS [all]: GLISS is the program; 10^6 samples on oneTBB and OpenCL and 10^5 on
# the rest, or with `all` 10^6 and all methods on each. OpenCL is compared where it is PoCL, which
# computes as the host does.
set -eu
gliss=$1
all=${2:-}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$gliss" generate knot -o "$scratch/knot.obj" >/dev/null
pocl=
if "$gliss" devices >"$scratch/devices" 2>"$scratch/error"; then
  # Its number: that of its first line.
  pocl=$(awk '/^[0-9]+: / {n = $1 + 0} /Portable Computing Language/ {print n; exit}' \
    "$scratch/devices")
  [ -n "$pocl" ] || echo "left out: opencl (no device of PoCL)"
else
  echo "left out: opencl ($(head -n 1 "$scratch/error"))"
fi

# same SAMPLES METHODS PRECISION ISA BACKEND [OPTION...]: its hash is that of the first since want=.
same() {
  samples=$1 methods=$2 precision=$3 isa=$4
  shift 4
  hash=$({
    GLISS_ISA=$isa "$gliss" sweep "$scratch/knot.obj" --unit mm --depth 2mm --quiet \
      --samples "$samples" --method "$methods" --precision "$precision" --backend "$@" \
      -o - 2>"$scratch/error" || touch "$scratch/failed"
  } | sha256sum | cut -c 1-64)
  [ ! -e "$scratch/failed" ] || { cat "$scratch/error" >&2; exit 1; }
  want=${want:-$hash}
  [ "$hash" = "$want" ] || { echo "$want, but $hash: $precision, $isa, $*" >&2; exit 1; }
  echo "$hash $samples samples, $methods, $precision: $isa, $*"
}

for precision in double float; do
  many="1e6 gregory $precision" few="1e5 gregory,shaded,flat $precision"
  [ -z "$all" ] || many="1e6 gregory,shaded,flat $precision" few="1e6 gregory,shaded,flat $precision"
  want=
  same $many baseline tbb --threads 2
  [ -z "$pocl" ] || same $many baseline opencl --device "$pocl" --threads 2
  [ -n "$all" ] || want=
  same $few baseline serial
  for isa in v3 v4; do
    same $few $isa tbb --threads 2
  done
  for threads in 1 4; do
    same $few v3 tbb --threads $threads
  done
  [ -z "$pocl" ] || same $few v3 opencl --device "$pocl" --threads 1
done
