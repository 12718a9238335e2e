#!/bin/sh
# Installs the build tree given as $1, builds the consumer project $2 against it in $3, and runs it.
set -eu
rm -rf "$3"
cmake --install "$1" --prefix "$3/prefix" >/dev/null
cmake -S "$2" -B "$3/build" -DCMAKE_PREFIX_PATH="$3/prefix" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$3/build"
"$3/build/consumer"
"$3/prefix/bin/gliss" --version
