#!/bin/sh
# Installs the build tree given as $1, builds the consumer project $2 against it in $3, and runs it: as it
# is, and built for the instruction sets that this machine has besides. All must print the same.
set -eu
rm -rf "$3"
cmake --install "$1" --prefix "$3/prefix" >/dev/null
cmake -S "$2" -B "$3/build" -DCMAKE_PREFIX_PATH="$3/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$3/build" --parallel 2
cd "$3/build"

has_v3() {
  for flag in avx2 bmi2 fma; do grep -qw "$flag" /proc/cpuinfo || return 1; done
}

run() {
  "./$1" >"$1.txt" && return
  status=$?
  cat "$1.txt"
  echo "$1 ended with status $status" >&2
  exit 1
}

run consumer
cat consumer.txt
for arch in x86-64-v3 native; do
  if [ ! -x consumer_$arch ] || { [ $arch = x86-64-v3 ] && ! has_v3; }; then
    echo "-march=$arch: skipped on this machine"
    continue
  fi
  run consumer_$arch
  cmp consumer.txt consumer_$arch.txt
  echo "-march=$arch: the same forces"
done
"$3/prefix/bin/gliss" --version
