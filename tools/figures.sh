#!/usr/bin/env bash
# Pages to look at: forces along paths and over surfaces, at two depths, with three methods, and what levels cost. Of the
# generated knot and banana, and of the teeth and the hand where ../shared/meshes holds them.
#
#   tools/figures.sh [GLISS]    the program; default: build/gliss, or the quickstart's
set -euo pipefail
cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
gliss=${1-}
for build in build build-quickstart; do
  [[ -n $gliss || ! -x $build/gliss ]] || gliss=$PWD/$build/gliss
done
[[ -x $gliss ]] || { echo "There is no program '${gliss:-build/gliss}': tools/quickstart.sh builds it." >&2; exit 2; }
gliss=$(realpath -- "$gliss")
mkdir -p results
cd results

pages=()
# page NAME MESH DEPTHS FORCES...: sweeps the mesh and compares levels on it; what was traced along paths comes first on
# the page.
page() {
  local name=$1 mesh=$2 depths=$3
  "$gliss" bake "$mesh" --unit mm -o "$name.gliss" --quiet
  "$gliss" sweep "$name.gliss" --depth "$depths" --samples 9e4 --method gregory,shaded,flat --unit mm -o "$name.h5" --quiet
  "$gliss" compare "$mesh" --unit mm --depth "$depths" --picture --json --quiet >"$name.json"
  "$gliss" report "${@:4}" "$name.h5" "$name.json" -o "$name.html" --quiet
  pages+=("$PWD/$name.html")
  echo "$name.html"
}
# trace NAME MESH DEPTH: forces along a path that was written before.
trace() {
  "$gliss" trace "$2" --path "$1_path_$3.csv" --stiffness 0.5N/mm --settle 0 --method gregory,shaded,flat --unit mm \
    -o "$1_path_$3.h5" --quiet
}

"$gliss" generate knot -o knot.obj --quiet
"$gliss" generate banana -o banana.obj --quiet
for depth in 2 4; do
  ../tools/knot_path.py $depth >knot_path_${depth}mm.csv
  ../tools/slide_path.py "$gliss" banana.obj $depth >banana_path_${depth}mm.csv
  trace knot knot.obj ${depth}mm
  trace banana banana.obj ${depth}mm
done
page knot knot.obj 2mm,4mm knot_path_2mm.h5 knot_path_4mm.h5
page banana banana.obj 2mm,4mm banana_path_2mm.h5 banana_path_4mm.h5
# The teeth are some 7 mm wide: 4 mm would be beyond their middle.
for surface in teeth32_ngon:0.5mm,1mm hand_webxr:2mm,4mm; do
  name=${surface%:*} mesh=../../shared/meshes/${surface%:*}.obj
  if [[ -f $mesh ]]; then page "$name" $mesh "${surface#*:}"; else echo "$name: skipped, ../shared/meshes is not here"; fi
done
echo "Open in a browser:"
printf '  %s\n' "${pages[@]}"
