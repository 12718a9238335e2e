#!/bin/sh
# Installs the shared libraries of the build tree $1, looks at the names that they give and export, and builds the
# consumer projects of $2 against them in $3 with the flags $4, of the sanitizers that the libraries were built with, and
# runs both.
set -eu
. "$(dirname "$0")/support/skip.sh"
rm -rf "$3"
cmake --install "$1" --prefix "$3/prefix" >/dev/null

for component in core runtime files tables engine study haply scene; do
  library=$(find "$3/prefix" -name "libgliss_$component.so")
  [ -n "$library" ] || { echo "libgliss_$component.so is not installed"; exit 1; }
  name=$(readelf -d "$library" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')
  expr "$name" : "libgliss_$component\.so\.[0-9]*\.[0-9]*$" >/dev/null ||
    { echo "$library: its SONAME is '$name'"; exit 1; }
  [ -e "$(dirname "$library")/$name" ] || { echo "$library: $name is not beside it"; exit 1; }
  # Weak ones are whoever's that makes them, as the functions of std::vector; sanitizers have markers of their own.
  names=$(nm -D -C --defined-only "$library" | sed -n 's/^[0-9a-f]* [TDBR] //p' | grep -v '^__odr_asan')
  [ "$(echo "$names" | grep -c '^gliss::')" -gt 5 ] || { echo "$library: exports next to nothing"; exit 1; }
  if echo "$names" | grep -v '^gliss::'; then
    echo "$library exports what is not Gliss's own"
    exit 1
  fi
  if echo "$names" | grep -E 'gliss::(baseline|v3|v4|\(anonymous)'; then
    echo "$library exports its insides"
    exit 1
  fi
done

build() {
  cmake -S "$1" -B "$2" -DCMAKE_PREFIX_PATH="$3/prefix" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS="$4" \
    -DLOOP_SOURCE="$(dirname "$0")/loop/loop_alone.cpp" >/dev/null
  cmake --build "$2" --parallel 2 --target "$5"
}
build "$2" "$3/build" "$3" "$4" consumer
build "$2/loop" "$3/loop" "$3" "$4" loop
cd "$3/build"
sh "$(dirname "$0")/sanitized.sh" ./consumer
sh "$(dirname "$0")/sanitized.sh" "$3/loop/loop"
if ldd "$3/loop/loop" | grep -E 'hdf5|fmt|boost|tbb|OpenCL'; then
  echo "a loop is linked with these"
  exit 1
fi
