#!/usr/bin/env bash
# For whoever changes Gliss: builds the program and the tests for one instruction set, without optimising much,
# and runs those tests that the arguments name.
#
#   tools/dev.sh                     builds
#   tools/dev.sh -R 'Track|Nearest'  builds and runs tests; arguments go to ctest
#   tools/dev.sh gliss               builds one target
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
# Precompiled headers are kept by ccache, where it is installed, only if it may ignore their times.
export CCACHE_SLOPPINESS=pch_defines,time_macros
cmake --preset dev >/dev/null
if [[ $# == 1 && $1 != -* ]]; then exec cmake --build --preset dev --parallel "$(nproc)" --target "$1"; fi
cmake --build --preset dev --parallel "$(nproc)"
if (($#)); then exec ctest --preset dev --parallel "$(nproc)" "$@"; fi
