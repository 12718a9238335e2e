#!/bin/sh
# Every instruction set gives the same bytes. usage: isa_parity.sh GLISS, the program.
set -eu
gliss=$1
. "$(dirname "$0")/support/isas.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

for mesh in knot fin goldberg banana; do
  "$gliss" generate $mesh -o "$scratch/$mesh.obj" >/dev/null
done
"$gliss" generate torus --irregular 1 -o "$scratch/torus.obj" >/dev/null
# Points all over the domain of a quad, its centre, corners and sides included.
awk 'BEGIN {
  print "face,xi,eta"
  for (p = 0; p < 1440; p += 7) {
    printf "%d,0,0\n%d,1,0\n%d,0,1\n%d,0.5,0.5\n", p, p, p, p
    for (i = 0; i < 12; ++i) {
      r = ((p * 12 + i) % 97) / 97; a = ((p * 5 + i * 13) % 89) / 89 - 0.5
      printf "%d,%.17g,%.17g\n", p, r * (0.5 + a), r * (0.5 - a)
    }
  }
}' >"$scratch/at.csv"

awk 'BEGIN {
  print "x,y,z"
  for (i = 0; i < 500; ++i) {
    a = (i * 37 % 499) / 499 * 6.2832; b = (i * 61 % 491) / 491 * 6.2832; r = 8 + i % 5
    printf "%.17g,%.17g,%.17g\n", (30 + r * cos(b)) * cos(a), (30 + r * cos(b)) * sin(a), r * sin(b)
  }
}' >"$scratch/hips.csv"

compared=
for precision in double float; do
  for isa in $(isas_here); do
    out=$scratch/$precision.$isa.csv
    GLISS_ISA=$isa "$gliss" eval "$scratch/knot.obj" --at "$scratch/at.csv" --unit mm \
      --precision $precision -o "$out" >/dev/null
    cmp "$scratch/$precision.baseline.csv" "$out"
    for level in ribbon bezier table; do
      GLISS_ISA=$isa "$gliss" eval "$scratch/knot.obj" --at "$scratch/at.csv" --unit mm --level $level \
        --precision $precision -o "$scratch/$level.$precision.$isa.csv" >/dev/null
      cmp "$scratch/$level.$precision.baseline.csv" "$scratch/$level.$precision.$isa.csv"
    done
    # Caches, of 3 to 11 sides and with faces that fold (the fin).
    for mesh in knot fin goldberg banana torus; do
      for construction in paper fair; do
        made=$scratch/$mesh.$construction.$precision
        GLISS_ISA=$isa "$gliss" bake "$scratch/$mesh.obj" --unit mm --precision $precision --quiet \
          --construction $construction -o "$made.$isa.gliss" >/dev/null
        cmp "$made.baseline.gliss" "$made.$isa.gliss"
      done
    done
    # Points and nearest points of fair triangles.
    GLISS_ISA=$isa "$gliss" project "$scratch/torus.obj" --unit mm --construction fair \
      --hip "$scratch/hips.csv" --precision $precision -o "$scratch/fair.$precision.$isa.csv" >/dev/null
    cmp "$scratch/fair.$precision.baseline.csv" "$scratch/fair.$precision.$isa.csv"
    compared="$compared $precision/$isa"
  done
done
lines=$(wc -l <"$scratch/double.baseline.csv")
echo "the same $lines lines at 4 levels and 10 caches:$compared"
