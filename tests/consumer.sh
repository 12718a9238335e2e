#!/bin/sh
# Installs the build tree given as $1 in $3, and builds and runs the programs of the pages, by their own lines (with the
# Python $5). Then builds the consumer project $2, and runs it: as it is, as C++23, and built for the instruction sets
# that this machine has besides. All must print the same. Then builds the source $4 with a loop's libraries alone, and
# runs it as it is and under sanitizers; and of the examples the device of one's own, and the hand in C by CMake and by
# pkg-config.
set -eu
. "$(dirname "$0")/support/skip.sh"
# The quickstart builds what docs/library.md's first line installs.
grep -q 'target installed' "$(dirname "$0")/../tools/quickstart.sh"
cmake --build "$1" --target installed >/dev/null
"$5" "$(dirname "$0")/page_lines.py" "$1" "$(dirname "$0")/../docs" "$3"
cmake -S "$2" -B "$3/build" -DCMAKE_PREFIX_PATH="$3/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$3/build" --parallel 2
cmake -S "$2/loop" -B "$3/loop" -DCMAKE_PREFIX_PATH="$3/prefix" -DCMAKE_BUILD_TYPE=Release -DLOOP_SOURCE="$4" >/dev/null
cmake --build "$3/loop" --parallel 2
cmake -S "$2/c" -B "$3/c" -DCMAKE_PREFIX_PATH="$3/prefix" >/dev/null
cmake --build "$3/c"
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
run consumer_cxx23
cmp consumer.txt consumer_cxx23.txt
echo "C++23: the same forces"
for arch in x86-64-v3 native; do
  if [ ! -x consumer_$arch ] || { [ $arch = x86-64-v3 ] && ! has_v3; }; then
    echo "-march=$arch: skipped on this machine"
    continue
  fi
  run consumer_$arch
  cmp consumer.txt consumer_$arch.txt
  echo "-march=$arch: the same forces"
done

cd ../loop
./loop
# Some kernels lay memory out as a sanitizer cannot take it, unless they are asked not to.
straight=
command -v setarch >/dev/null && setarch -R true 2>/dev/null && straight="setarch -R"
if $straight ./loop_sanitized >sanitized.txt 2>&1; then
  cat sanitized.txt
  echo "under sanitizers: sound"
elif grep -qE "unexpected memory mapping|Shadow memory range interleaves" sanitized.txt; then
  leave_out_unless_required "this kernel lays memory out as the sanitizers cannot take it"
else
  cat sanitized.txt
  exit 1
fi
./own_device >own_device.txt
cat own_device.txt
grep -qE '^stopped; at most (0\.[5-9]|1\.0).* N, in the end 0\.00 N$' own_device.txt
"$3/prefix/bin/gliss" --version

cd ../c
"$3/prefix/bin/gliss" generate goldberg -o ball.obj --quiet
./hand ball.obj 0.001 >hand.txt
if command -v pkg-config >/dev/null; then
  pc=$(find "$3/prefix" -name gliss.pc -exec dirname {} \;)
  PKG_CONFIG_PATH=$pc pkg-config --exact-version="$("$3/prefix/bin/gliss" --version | sed 's/^gliss \([0-9.]*\).*/\1/;q')" gliss
  # shellcheck disable=SC2046  # options, word by word
  cc -std=c99 -pedantic -Wall -Wextra -Werror "$2/../../examples/hand.c" $(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs gliss) \
    -Wl,-rpath,"$(dirname "$pc")" -o hand_pkg_config
  ./hand_pkg_config ball.obj 0.001 >hand_pkg_config.txt
  cmp hand.txt hand_pkg_config.txt
  echo "C by CMake and by pkg-config: the same forces"
else
  leave_out_unless_required "no pkg-config"
fi
