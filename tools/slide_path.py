#!/usr/bin/env python3
"""Writes a path of HIPs DEPTH mm beneath a mesh in mm, 0.15 mm a tick, as CSV: below a line that winds above the
mesh along its longest side. Usage: tools/slide_path.py GLISS MESH DEPTH > path.csv
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

STEP = 0.15  # mm a tick
POINTS = 400  # of the line


def surface_beneath(gliss, mesh, points, folder):
    """(nearest point, outward normal) of the mesh for each point."""
    hips, out = folder / "hips.csv", folder / "nearest.csv"
    hips.write_text("x,y,z\n" + "".join(f"{x},{y},{z}\n" for x, y, z in points))
    subprocess.run([gliss, "project", mesh, "--hip", hips, "--unit", "mm", "-o", out, "--quiet"], check=True)
    with open(out, newline="") as file:
        return [([float(row[k]) for k in ("x", "y", "z")], [float(row[k]) for k in ("nx", "ny", "nz")])
                for row in csv.DictReader(file)]


def offset(foot, depth):
    return [p - depth * n for p, n in zip(*foot)]


def resampled(points, step):
    """Points `step` apart along the same line."""
    out, left = [points[0]], step
    for a, b in zip(points, points[1:]):
        length = math.dist(a, b)
        at = left
        while at <= length and length > 0:
            out.append([p + (q - p) * at / length for p, q in zip(a, b)])
            at += step
        left = at - length
    return out


def line_above(gliss, mesh):
    said = subprocess.run([gliss, "info", mesh, "--unit", "mm", "--json"], check=True, stdout=subprocess.PIPE)
    low, high = json.loads(said.stdout)["bounds"]
    short, middle, long = sorted(range(3), key=lambda axis: high[axis] - low[axis])
    for i in range(POINTS + 1):
        point = [(a + b) / 2 for a, b in zip(low, high)]
        point[short] = high[short] + 0.5 * (high[short] - low[short])
        point[middle] += 0.3 * (high[middle] - low[middle]) * math.sin(6 * math.pi * i / POINTS)
        point[long] = low[long] + (high[long] - low[long]) * (0.08 + 0.84 * i / POINTS)
        yield point


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    gliss, mesh, depth = sys.argv[1], sys.argv[2], float(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        feet = surface_beneath(gliss, mesh, line_above(gliss, mesh), pathlib.Path(folder))
    sys.stdout.write("step,x_mm,y_mm,z_mm\n")
    for step, (x, y, z) in enumerate(resampled([offset(foot, depth) for foot in feet], STEP)):
        sys.stdout.write(f"{step},{x:.9f},{y:.9f},{z:.9f}\n")


if __name__ == "__main__":
    main()
