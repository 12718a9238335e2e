#!/usr/bin/env python3
"""Says how far patches leave their polygons, as a table of Markdown: the largest distance, of the size; the largest share of
the room there (docs/method.md, Faithfulness); and the share of random points, farther than 2 % of the size from the polygons,
that are inside by the patches and outside by the polygons, or the other way.

Usage: bench/faithful.py GLISS FOLDER_OR_MESH... [--crease auto,none,...] [--points 3000] [--construction fair] [--unit mm]

GLISS is the program; FOLDER holds .obj, .off, .ply and .stl files; a plate, a needle, a bracket, a nut, a cylinder, slabs with
round rims and the generated knot, goldberg and banana come first. A column for each --crease; "usual" is none given.
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

from walks import meshes_of


def prism(outline, height):
    """An extruded polygon, anticlockwise."""
    n = len(outline)
    faces = [list(range(n))[::-1], list(range(n, 2 * n))]
    faces += [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return [(x, y, z) for z in (0, height) for x, y in outline], faces


def ring(radius, sides):
    return [(radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides)) for k in range(sides)]


def slab(length, width, height, radius, rim, corner):
    """A slab with round corners and a half round rim in triangles, as CAD exports it: long strips beside fine arcs."""
    around, points, faces = 4 * (corner + 1), [], []
    for i in range(rim + 1):
        up = math.pi * (i / rim - 0.5)
        out = radius - height / 2 * (1 - math.cos(up))
        for k in range(around):
            quarter, step = divmod(k, corner + 1)
            turn = math.pi / 2 * (quarter + step / corner)
            points.append(((length / 2 - radius) * (1 if quarter in (0, 3) else -1) + out * math.cos(turn),
                           (width / 2 - radius) * (1 if quarter < 2 else -1) + out * math.sin(turn), height / 2 * math.sin(up)))
    for i in range(rim):
        for k in range(around):
            a, b, c, d = (r * around + j % around for r, j in ((i, k), (i, k + 1), (i + 1, k + 1), (i + 1, k)))
            faces += [[a, b, c], [a, c, d]]
    for cap in (list(range(around))[::-1], range(rim * around, (rim + 1) * around)):
        faces += [[cap[0], cap[k], cap[k + 1]] for k in range(1, around - 1)]
    return points, faces


PARTS = {"plate 40 x 40 x 0.2": prism([(0, 0), (40, 0), (40, 40), (0, 40)], 0.2),
         "needle 1 x 100": prism(ring(0.5, 12), 100),
         "bracket": prism([(0, 0), (40, 0), (40, 4), (4, 4), (4, 40), (0, 40)], 20), "nut": prism(ring(10, 6), 8),
         "cylinder": prism(ring(10, 24), 60), "round slab 203 x 305 x 12.7": slab(203.2, 304.8, 12.7, 25.4, 12, 6),
         "round bar 20 x 300 x 4": slab(20, 300, 4, 4, 6, 3)}


def parts_in(folder):
    for name, (points, faces) in PARTS.items():
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
    parser.add_argument("--construction", default="fair", choices=("fair", "paper"))
    parser.add_argument("--unit", default="mm")
    options = parser.parse_args()
    creases = options.crease.split(",")
    print("| mesh | " + " | ".join(creases) + " |\n|---|" + "---|" * len(creases), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for mesh in [*parts_in(folder), *meshes_of(options.meshes, options.gliss, folder)]:
            cells = []
            for crease in creases:
                try:
                    cells.append(cell(mesh, crease, options, folder))
                except RuntimeError as error:
                    cells.append(str(error).replace("|", "/"))
            print(f"| {mesh.stem} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
