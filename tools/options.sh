#!/usr/bin/env bash
# Builds and installs Gliss without each of its parts in turn, as if the packages that no other part needs were not
# there, and a program that uses all that is left. LOOP is the loop with Eigen alone. This is for the night: it takes
# minutes with ccache, and hours without.
#
#   tools/options.sh                     all
#   tools/options.sh TABLES LOOP         without the tables; the loop alone
#   tools/options.sh --configure LOOP    only configures
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}"
# The builds share what they compile.
export CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_BASEDIR=$PWD
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
configure=
if [[ ${1-} == --configure ]]; then configure=1; shift; fi
names=$* tried=

# $1: a name; $2: parts that are OFF; $3: packages that are not there; $4: components that are left.
without() {
  [[ -z $names || " $names " == *" $1 "* ]] || return 0
  tried=1
  local build=build-options/$1 words=() word
  for word in $2; do words+=("-DGLISS_$word=OFF"); done
  for word in $3; do words+=("-DCMAKE_DISABLE_FIND_PACKAGE_$word=ON"); done
  echo "== $1"
  rm -rf "$build"
  cmake --preset dev -B "$build" "${words[@]}" --no-warn-unused-cli | sed -n '/^-- GLISS/p'
  local built
  built=$(sed -n 's/^set(gliss_built \(.*\))$/\1/p' "$build/gliss-config.cmake")
  [[ $built == "$4" ]] || { echo "It has $built, not $4" >&2; exit 1; }
  if [[ $configure ]]; then return; fi
  cmake --build "$build" --target installed
  cmake --install "$build" --prefix "$build/prefix" >/dev/null
  cmake -G Ninja -S tests/consumer/parts -B "$build/parts" -DCMAKE_PREFIX_PATH="$PWD/$build/prefix" "${words[@]}" \
    --no-warn-unused-cli >/dev/null
  cmake --build "$build/parts"
  "$build/parts/parts"
}
without FILES FILES "HDF5 CLI11" "core;runtime;engine;haply"
without TABLES TABLES "HDF5 CLI11" "core;runtime;files;engine;study;haply;c"
without ENGINE ENGINE "TBB OpenCL Python3 CLI11" "core;runtime;files;tables;haply;scene"
without HAPLY HAPLY "nlohmann_json CLI11" "core;runtime;files;tables;engine;study;scene;c"
without SCENE SCENE CLI11 "core;runtime;files;tables;engine;study;haply;c"
without TOOLS TOOLS CLI11 "core;runtime;files;tables;engine;study;haply;scene;c"
without REPORT REPORT "" "core;runtime;files;tables;engine;study;haply;scene;c"
without LOOP "FILES TABLES ENGINE HAPLY SCENE TOOLS" "fmt HDF5 TBB OpenCL Python3 Boost nlohmann_json CLI11" "core;runtime"
[[ $tried ]] || { sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2; }
