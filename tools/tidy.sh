#!/usr/bin/env bash
# For whoever changes Gliss: finds faults and waste by .clang-tidy in files of host/, runtime/ and tools/. Nothing is
# built for it: clang-tidy reads the sources without the headers that another compiler precompiled.
#
#   tools/tidy.sh host/query/query.cpp   these files
#   tools/tidy.sh                        those that differ from the last commit
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
files=("$@")
if ((!$#)); then mapfile -t files < <(git diff --name-only --diff-filter=d HEAD -- '*.cpp'); fi
if ((!${#files[@]})); then exit; fi
cmake --preset dev -B build-tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy-14 -p build-tidy --quiet --warnings-as-errors='*'
