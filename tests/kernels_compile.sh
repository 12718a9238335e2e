#!/bin/sh
# The programs of kernels/ as OpenCL C, for both versions, both precisions and the widths in use. usage: kernels_compile.sh ROOT. Exit code 77: no clang.
set -eu
root=$1
. "$(dirname "$0")/support/skip.sh"
command -v clang >/dev/null 2>&1 || skip_unless_required "clang is absent"

for version in CL1.2 CL3.0; do
  for scalar in float double; do
    # A device without fp64 must be able to compile what is float.
    extensions=
    [ $scalar = float ] && extensions="-Xclang -cl-ext=-cl_khr_fp64,-__opencl_c_fp64"
    for lanes in 1 4 8 16; do
      for program in "$root"/kernels/*.cl; do
        # The others take one sample a work-item.
        case $lanes:$program in 1:* | *evaluate.cl | *examine.cl) ;; *) continue ;; esac
        clang -x cl -cl-std=$version -Xclang -finclude-default-header -fsyntax-only -Wall -Wextra \
          -Werror -Wdouble-promotion -Wno-unused-function $extensions -DGLISS_SCALAR=$scalar \
          -DGLISS_LANES=$lanes -DGLISS_GROUP=64 -I"$root" "$program"
        echo "compiled: $version, $scalar, $lanes lanes, ${program##*/}"
      done
    done
  done
done
