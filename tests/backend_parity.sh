#!/bin/sh
# One SHA-256 for a sweep by every backend, number of threads and instruction set.
# usage: backend_parity.sh GLISS [METHODS [SAMPLES]]: GLISS is the program, METHODS are gregory without it.
# OpenCL is compared where it is PoCL, which computes as the host does.
set -eu
gliss=$1
. "$(dirname "$0")/support/isas.sh"
. "$(dirname "$0")/support/skip.sh"
methods=${2:-gregory}
samples=${3:-1e5}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$gliss" generate knot -o "$scratch/knot.obj" >/dev/null
pocl=
if "$gliss" devices >"$scratch/devices" 2>/dev/null; then
  # Its number: that of its first line.
  pocl=$(awk '/^[0-9]+: / {n = $1 + 0} /Portable Computing Language/ {print n; exit}' \
    "$scratch/devices")
fi
[ -n "$pocl" ] || leave_out_unless_required "there is no device of PoCL"
best=$(isas_here | tail -n 1)

# same ISA BACKEND [OPTION...]: its hash is that of the first.
same() {
  isa=$1
  shift
  hash=$({
    GLISS_ISA=$isa "$gliss" sweep "$scratch/knot.obj" --unit mm --depth 2mm --quiet \
      --samples "$samples" --method "$methods" --precision "$precision" --backend "$@" \
      -o - 2>"$scratch/error" || touch "$scratch/failed"
  } | sha256sum | cut -c 1-64)
  [ ! -e "$scratch/failed" ] || { cat "$scratch/error" >&2; exit 1; }
  want=${want:-$hash}
  [ "$hash" = "$want" ] || { echo "$want, but $hash: $precision, $isa, $*" >&2; exit 1; }
  echo "$hash $methods, $precision: $isa, $*"
}

for precision in double float; do
  want=
  same "$best" serial
  for isa in $(isas_here); do
    same $isa tbb --threads 2
  done
  for threads in 1 4; do
    same "$best" tbb --threads $threads
  done
  [ -z "$pocl" ] || same "$best" opencl --opencl-device "$pocl" --threads 2
done
