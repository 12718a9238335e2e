#!/bin/sh
# The loop needs none of the libraries that files, studies, engines and scenes do. usage: loop_links.sh PROGRAM
# LIBRARY...: the program of loop_alone.cpp, and the libraries that it is linked with.
set -eu
program=$1
shift
"$program"
if ldd "$program" | grep -E 'hdf5|fmt|boost|tbb|OpenCL'; then
  echo "$program: linked with these"
  exit 1
fi
for library in "$@"; do
  if nm -C "$library" 2>/dev/null | grep -E '\b(fmt|boost|tbb|oneapi|toml|nlohmann|cl)::|\bU (H5|cl[A-Z])'; then
    echo "$library: has or wants these"
    exit 1
  fi
  nm "$library" 2>/dev/null | grep -c ' T ' >/dev/null || { echo "$library: nm sees no function"; exit 1; }
done
