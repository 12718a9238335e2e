#!/usr/bin/env bash
# From a fresh Debian 12 or Ubuntu 22.04/24.04 to forces: installs packages (as root or with sudo), builds
# the program, bakes a mesh, sweeps the force beneath its surface with three methods, and traces a path.
#
#   tools/quickstart.sh              the generated torus knot
#   tools/quickstart.sh MESH UNIT    a mesh of yours (.obj, .off, .ply, .stl) and its unit, such as mm
set -euo pipefail
case $#${1-} in
  0 | 2[!-]*) ;;
  *) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 2 ;;
esac
[[ $# == 0 || -f $1 ]] || { echo "There is no file '$1'." >&2; exit 2; }
# What would stop it after the build.
case ${1+${1,,}} in
  '' | *.obj | *.off | *.ply | *.stl) ;;
  *) echo "'$1' must end in one of .obj, .off, .ply, .stl, which Blender and MeshLab export." >&2; exit 2 ;;
esac
case ${2-mm} in
  m | cm | mm | um | nm | in | inch | *metre | *meter) ;;
  *) echo "'$2' is not a unit: m, cm, mm, um, nm or in is one." >&2; exit 2 ;;
esac
mesh=${1:+$(realpath -- "$1")} unit=${2:-mm}

cd "$(dirname -- "${BASH_SOURCE[0]}")/.."
source tools/packages.sh
install_packages "${build_packages[@]}"

build=build-quickstart
configure() { cmake --preset release -B $build -DGLISS_TESTS=OFF -DGLISS_BENCH=OFF -DGLISS_WERROR=OFF "$@"; }
configure -UGLISS_REPORT
# The page of gliss report comes from npm's registry at its first build, which some networks keep off.
fetch_page() {
  echo "npm fetches what the page of gliss report is made of"
  cmake --build $build --target report_html
}
if grep -q '^GLISS_REPORT:BOOL=ON' $build/CMakeCache.txt && ! fetch_page; then
  echo "The page of gliss report is left out, because npm cannot fetch what it needs. Behind a proxy, set" >&2
  echo "HTTPS_PROXY, or NODE_EXTRA_CA_CERTS to the file of its certificates, and run this again. All else goes on." >&2
  configure -DGLISS_REPORT=OFF
fi
cmake --build $build --target installed --parallel "$(nproc)"

say() { printf '\n== %s\n' "$*"; }
# As it could be typed.
show() {
  printf '$ gliss'
  local word
  for word in "$@"; do
    if [[ $word == *[!a-zA-Z0-9_./,:=-]* ]]; then printf ' %q' "$word"; else printf ' %s' "$word"; fi
  done
  printf '\n'
}
gliss() { show "$@"; $build/gliss "$@"; }

mkdir -p results
if [[ -z $mesh ]]; then
  say "A coarse mesh of a torus knot"
  mesh=results/knot.obj
  gliss generate knot -o $mesh
fi
name=results/$(basename -- "${mesh%.*}")

say "Its patches"
gliss bake "$mesh" --unit "$unit" -o "$name.gliss"

# A mesh of yours is touched 0.5 % and 1 % of its diagonal deep.
shallow=2mm deep=4mm
if (($# > 0)); then
  read -r shallow deep < <($build/gliss info "$name.gliss" --unit "$unit" --json --quiet | python3 -c '
import json, math, sys
across = math.dist(*json.load(sys.stdin)["bounds"])
print(*(f"{share * across:.2g}{sys.argv[1]}" for share in (0.005, 0.01)))' "$unit")
fi

say "How smooth the force is over the whole surface: a million points a depth"
gliss sweep "$name.gliss" --depth "$shallow,$deep" --samples 1e6 --method gregory,shaded,flat --unit "$unit" \
  --summary "$name.json"

say "The forces themselves, at fewer points"
gliss sweep "$name.gliss" --depth "$shallow,$deep" --samples 1e5 --method gregory,shaded,flat --unit "$unit" \
  -o "$name.h5" --vtp "$name.vtp" --quiet

say "A finger that slides $shallow beneath the surface"
path=(--depth "$shallow")
if (($# == 0)); then
  tools/knot_path.py >"${name}_path.csv"
  path=(--path "${name}_path.csv")
fi
gliss trace "$name.gliss" "${path[@]}" --unit "$unit" --stiffness 0.5N/mm --settle 0 \
  --method gregory,shaded,flat -o "${name}_forces.csv"
tools/draw_forces.py "${name}_forces.csv" "${name}_forces.svg"

say "All of this as a page"
gliss report "${name}_forces.csv" "$name.h5" -o "$name.html" || echo "The page is left out."

say "Done. In $PWD/results:"
row() { printf '  %-18s %s\n' "$(basename -- "$name")$1" "$2"; }
row .gliss "the patches, for every other command"
row .json "how smooth each method is at each depth: step_N, edge_step_N, angle_rad, error_N"
row .h5 "samples with their forces (Python: h5py)"
if [[ -f $name.html ]]; then row .html "look at this one first, in a browser"; fi
row .vtp "HIPs with their forces for ParaView; _mesh.vtp: the mesh with each face's least radius of curvature (rho_min)"
row _forces.csv "force at each tick of the path"
row _forces.svg "what the force changes by from tick to tick, as a picture"
echo "The program is $build/gliss; $build/gliss --help lists its commands."
