#!/bin/sh
# The kernels are OpenCL C too: every header of kernels/, for both versions, both precisions and the
# widths in use. usage: kernels_compile.sh ROOT. Exit code 77: no clang.
set -eu
root=$1
command -v clang >/dev/null 2>&1 || { echo "skipped: clang is absent"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

echo '#include "kernels/kernels.h"' >"$scratch/all.cl"
for version in CL1.2 CL3.0; do
  for scalar in float double; do
    for lanes in 1 8 16; do
      clang -x cl -cl-std=$version -Xclang -finclude-default-header -fsyntax-only -Wall -Wextra \
        -Werror -Wdouble-promotion -Wno-unused-function -DGLISS_SCALAR=$scalar \
        -DGLISS_LANES=$lanes -I"$root" "$scratch/all.cl"
      echo "compiled: $version, $scalar, $lanes lanes"
    done
  done
done
