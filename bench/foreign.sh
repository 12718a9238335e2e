#!/usr/bin/env bash
# Counts how often the force jumps on meshes of yours, as bench/walks.py does on those of the project: fair patches
# beside force shading and flat polygons, and on how many meshes which jumps less.
# Usage: bench/foreign.sh MESH_OR_FOLDER... [--unit mm] [--ticks 100000] [--seed 1]
# Takes the program that tools/quickstart.sh has built, or the one that GLISS names.
set -euo pipefail
here=$(dirname -- "${BASH_SOURCE[0]}")
gliss=${GLISS:-$here/../build-quickstart/gliss}
if [[ ! -x $gliss ]]; then
  echo "bench/foreign.sh: there is no program '$gliss': run tools/quickstart.sh, or set GLISS" >&2
  exit 2
fi
if (($# == 0)); then
  echo "bench/foreign.sh: name a mesh or a folder of meshes" >&2
  exit 2
fi
exec python3 "$here/walks.py" "$gliss" --found "$@"
