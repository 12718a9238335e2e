#!/usr/bin/env bash
# From a fresh Debian 12 or Ubuntu 22.04/24.04 to forces: installs packages (as root or with sudo), builds
# the program, bakes a mesh, and sweeps the force 2 mm and 4 mm beneath its surface with three methods.
#
#   tools/quickstart.sh              the generated torus knot
#   tools/quickstart.sh MESH UNIT    a mesh of yours (.obj, .off, .ply) and its unit, such as mm
set -euo pipefail
case $#${1-} in
  0 | 2[!-]*) ;;
  *) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
[[ $# == 0 || -f $1 ]] || { echo "There is no file '$1'." >&2; exit 2; }
mesh=${1:+$(realpath -- "$1")} unit=${2:-mm}

cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}"

build=build-quickstart
cmake --preset release -B $build -DGLISS_TESTS=OFF -DGLISS_BENCH=OFF -DGLISS_WERROR=OFF
cmake --build $build --target gliss --parallel "$(nproc)"

say() { printf '\n== %s\n' "$*"; }
gliss() { echo "\$ gliss $*"; $build/gliss "$@"; }

mkdir -p results
if [[ -z $mesh ]]; then
  say "A coarse mesh of a torus knot"
  mesh=results/knot.obj
  gliss generate knot -o $mesh
fi
name=results/$(basename -- "${mesh%.*}")

say "Its patches"
gliss bake "$mesh" --unit "$unit" -o "$name.gliss"

say "How smooth the force is over the whole surface: a million points a depth"
gliss sweep "$name.gliss" --depth 2mm,4mm --samples 1e6 --method gregory,shaded,flat --unit "$unit" \
  --summary "$name.json"

say "The forces themselves, at fewer points"
gliss sweep "$name.gliss" --depth 2mm,4mm --samples 1e5 --method gregory,shaded,flat --unit "$unit" \
  -o "$name.h5" --vtp "$name.vtp" --quiet

if (($# == 0)); then
  say "A finger that slides 2 mm beneath the surface"
  tools/knot_path.py >"${name}_path.csv"
  gliss trace "$name.gliss" --path "${name}_path.csv" --unit mm --stiffness 0.5N/mm --settle 0 \
    --method gregory,shaded,flat -o "${name}_forces.csv"
  tools/draw_forces.py "${name}_forces.csv" "${name}_forces.svg"
fi

say "All of this as a page"
shown=("$name.h5")
if (($# == 0)); then shown=("${name}_forces.csv" "${shown[@]}"); fi
gliss report "${shown[@]}" -o "$name.html" || echo "The page is left out."

say "Done. In $PWD/results:"
row() { printf '  %-18s %s\n' "$(basename -- "$name")$1" "$2"; }
row .gliss "the patches, for every other command"
row .json "how smooth each method is at each depth: step_N, edge_step_N, angle_rad, error_N"
row .h5 "samples with their forces (Python: h5py)"
if [[ -f $name.html ]]; then row .html "look at this one first, in a browser"; fi
row .vtp "HIPs with their forces for ParaView; _mesh.vtp: the mesh with each face's least radius of curvature (rho_min)"
if (($# == 0)); then
  row _forces.csv "force at each tick of the path"
  row _forces.svg "what the force changes by from tick to tick, as a picture"
fi
echo "The program is $build/gliss; $build/gliss --help lists its commands."
