#!/usr/bin/env python3
"""Says how far patches leave their polygons, as a table of Markdown: the largest distance, of the size; the largest share of
the room there (docs/method.md, Faithfulness); and the share of random points, farther than 2 % of the size from the polygons,
that are inside by the patches and outside by the polygons, or the other way.

Usage: bench/faithful.py GLISS FOLDER_OR_MESH... [--crease auto,none,...] [--points 3000] [--random 0] [--seed 1]
                         [--construction fair] [--unit mm]

GLISS is the program; FOLDER holds .obj, .off, .ply and .stl files; a plate, a needle, a bracket, a nut, a cylinder, slabs with
round rims, --random parts of ten kinds (stars, frusta, combs, tubes ...) and the generated knot, goldberg and banana come
first. A column for each --crease; "usual" is none given.
"""

import argparse
import csv
import io
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

from parts import PARTS, random_parts
from walks import meshes_of


def parts_in(folder, options):
    named = ((name, *part) for name, part in PARTS.items())
    for name, points, faces in [*named, *random_parts(options.random, options.seed)]:
        path = pathlib.Path(folder) / f"{name}.obj"
        path.write_text("".join("v %.17g %.17g %.17g\n" % p for p in points) +
                        "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces))
        yield path


def run(options, *words):
    ran = subprocess.run([options.gliss, *map(str, words), "--unit", options.unit, "--quiet"], capture_output=True, text=True)
    if ran.returncode != 0:
        raise RuntimeError((ran.stderr.strip().splitlines() or ["failed"])[-1].removeprefix("gliss: "))
    return ran.stdout


def cell(mesh, crease, options, folder):
    how = ["--construction", options.construction] + ([] if crease == "usual" else ["--crease", crease])
    info = json.loads(run(options, "info", mesh, "--json", *how))
    low, high = info["bounds"]
    size = math.dist(low, high)
    draw = random.Random(7)
    hips = pathlib.Path(folder) / "hips.csv"
    hips.write_text("x,y,z\n" + "".join(
        ",".join(repr(a + draw.random() * (b - a) + 0.08 * size * (draw.random() - 0.5)) for a, b in zip(low, high)) + "\n"
        for _ in range(options.points)))
    found = [[float(row["distance"]) for row in csv.DictReader(io.StringIO(
        run(options, "project", mesh, "--hip", hips, "--method", method, "-o", "-", *how)))] for method in ("gregory", "flat")]
    judged = [(a, b) for a, b in zip(*found) if abs(b) > 0.02 * size]
    wrong = sum((a < 0) != (b < 0) for a, b in judged)
    tight = info["tightest"]
    share = f"{tight['mm'] / tight['room_mm']:.2g}" if tight["room_mm"] else "-"
    signs = "-" if info["border_sides"] or not judged else f"{100 * wrong / len(judged):.2g} %"
    return f"{info['departure']['mm'] / (size * {'mm': 1, 'm': 1e3, 'cm': 10}[info['unit']]):.2%}, {share}, {signs}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--crease", default="usual,none")
    parser.add_argument("--points", type=int, default=3000)
    parser.add_argument("--random", type=int, default=0, help="so many random parts as well (bench/parts.py)")
    parser.add_argument("--seed", type=int, default=1, help="of these")
    parser.add_argument("--construction", default="fair", choices=("fair", "paper"))
    parser.add_argument("--unit", default="mm")
    options = parser.parse_intermixed_args()
    creases = options.crease.split(",")
    print("| mesh | " + " | ".join(creases) + " |\n|---|" + "---|" * len(creases), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for mesh in [*parts_in(folder, options), *meshes_of(options.meshes, options.gliss, folder)]:
            cells = []
            for crease in creases:
                try:
                    cells.append(cell(mesh, crease, options, folder))
                except RuntimeError as error:
                    cells.append(str(error).replace("|", "/"))
            print(f"| {mesh.stem} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
