#!/usr/bin/env python3
"""How long each command takes on meshes that cost more than others: poles that many faces share, shells at one place,
parts without number (20,000 of them), needles, parts that all meet. No command may take over 60 s on 40,000 faces.

Prints a table of Markdown: seconds of each command on each mesh, evaluations and time of the worst tick, which is the
shortest of 3 runs, and the worst of all. Work: 200 HIPs to project, sweeps of 1,000 samples by three methods, traces
of 2,000 ticks, walks of 500. What takes longer than --limit is ended and shown as "over".
Usage: bench/hostile.py build/gliss [--faces 40000] [--only fan,shells] [--limit 120] [--json hostile.json]
"""

import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

GOAL = 60  # s
TETRAHEDRON = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
OCTAHEDRON = [(4, 0, 2), (4, 2, 1), (4, 1, 3), (4, 3, 0), (5, 2, 0), (5, 1, 2), (5, 3, 1), (5, 0, 3)]


def crossed(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.hypot(*a) for x in a]


def fans(faces, around):
    """Double cones of 2 x `around` faces, side by side."""
    for part in range(max(1, faces // (2 * around))):
        x = 3.0 * part
        turns = [2 * math.pi * i / around for i in range(around)]
        yield ([(x, 0, 1), (x, 0, -1)] + [(x + math.cos(t), math.sin(t), 0) for t in turns],
               [f for i in range(around) for a, b in [(2 + i, 2 + (i + 1) % around)] for f in ((0, a, b), (1, b, a))])


def octahedra(faces, place):
    """place(i): centre and three half axes."""
    for i in range(faces // 8):
        centre, axes = place(i)
        yield [tuple(c + sign * a for c, a in zip(centre, axis)) for axis in axes for sign in (1, -1)], OCTAHEDRON


def tetrahedra(parts):
    """Apart from each other, in a cube of rows."""
    side = math.ceil(parts ** (1 / 3))
    for i in range(parts):
        x, y, z = 2 * (i % side), 2 * (i // side % side), 2 * (i // side ** 2)
        yield [(x, y, z), (x + 1, y, z), (x, y + 1, z), (x, y, z + 1)], TETRAHEDRON


def needle(rng):
    along = unit([rng.gauss(0, 1) for _ in range(3)])
    aside = unit(crossed(along, (1, 0, 0) if abs(along[0]) < 0.7 else (0, 1, 0)))
    return (0, 0, 0), [[1e-3 * x for x in aside], [1e-3 * x for x in crossed(along, aside)], along]


def turned(rng, spread):
    """A unit octahedron that is turned anyhow, about anywhere in a cube."""
    x = unit([rng.gauss(0, 1) for _ in range(3)])
    y = unit(crossed(x, unit([rng.gauss(0, 1) for _ in range(3)])))
    return [rng.uniform(0, spread) for _ in range(3)], [x, y, crossed(x, y)]


def meshes(faces):
    """By name: what the mesh is, and its parts."""
    rng = random.Random(5)
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    side = math.ceil((faces / 8) ** (1 / 3))
    return {
        "pole": ("one double cone, two poles of as many faces as there may be", fans(faces, faces // 2)),
        "fans": ("double cones whose poles have 1,000 faces", fans(faces, min(1000, faces // 2))),
        "shells": ("octahedra, all the same", octahedra(faces, lambda i: ((0, 0, 0), axes))),
        "parts": ("octahedra apart from each other", octahedra(
            faces, lambda i: ((3 * (i % side), 3 * (i // side % side), 3 * (i // side ** 2)), axes))),
        "tetrahedra": ("as many as half the faces, apart from each other: twice the faces", tetrahedra(faces // 2)),
        "needles": ("octahedra of 1 : 1,000, all through one point", octahedra(faces, lambda i: needle(rng))),
        "crowd": ("octahedra, each of which meets hundreds", octahedra(faces, lambda i: turned(rng, 5))),
    }


def write_obj(parts, path):
    """Returns how many faces."""
    begin, count = 1, 0
    with path.open("w") as file:
        for positions, corners in parts:
            file.writelines("v %.17g %.17g %.17g\n" % tuple(p) for p in positions)
            file.writelines("f %d %d %d\n" % tuple(begin + c for c in f) for f in corners)
            begin += len(positions)
            count += len(corners)
    return count


def write_path(path, ticks=2000, every=1):
    """From outside through the middle, round it and along the first pole."""
    with path.open("w") as file:
        file.write("x,y,z\n")
        for i in range(0, ticks, every):
            t = i / ticks
            file.write("%.9g,%.9g,%.9g\n" % (0.3 * math.cos(40 * t) * (1 - t), 0.3 * math.sin(40 * t) * (1 - t), 1.2 - t))


SCENE = """[[object]]
cache = "mesh.gliss"
stiffness = "500N/m"
"""
RUN = "run scene.toml --device replay:path.csv --no-wait --record run.csv"

# Each with the name of its row. In the mesh's folder; mesh.gliss is what bake wrote.
COMMANDS = [
    ("check", "check mesh.obj"),
    ("bake", "bake mesh.obj -o mesh.gliss"),
    ("bake paper", "bake mesh.obj --construction paper -o paper.gliss"),
    ("info", "info mesh.gliss"),
    ("eval", "eval mesh.gliss --at points.csv -o eval.csv"),
    ("project", "project mesh.gliss --hip hips.csv -o project.csv"),
    ("sweep", "sweep mesh.gliss --depth 1mm --samples 1e3 -o sweep.csv"),
    ("trace", "trace mesh.gliss --path path.csv --method gregory,shaded,flat -o trace.csv"),
    ("trace paper", "trace paper.gliss --path path.csv --method gregory -o trace.csv"),
    ("compare", "compare mesh.obj --levels exact,flat --walks 1 --walk-ticks 500 --ticks 200 --dense-limit 0 -o compare.csv"),
    ("run", RUN),
]


def timed(gliss, words, folder, limit):
    """Seconds, and what went wrong."""
    start = time.perf_counter()
    try:
        ran = subprocess.run([gliss, *words.split(), "--quiet"], cwd=folder, timeout=limit,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    except subprocess.TimeoutExpired:
        return limit, "over"
    wrong = f"exit {ran.returncode}: {ran.stderr.strip().splitlines()[-1:]}" if ran.returncode else ""
    return time.perf_counter() - start, wrong


def column(path, name):
    with path.open() as file:
        at = file.readline().strip().split(",").index(name)
        return [line.rstrip("\n").split(",")[at] for line in file]


def measured(gliss, parts, folder, limit):
    faces = write_obj(parts, folder / "mesh.obj")
    write_path(folder / "path.csv")
    write_path(folder / "hips.csv", every=10)
    (folder / "points.csv").write_text("face,xi,eta\n0,0,0\n")
    (folder / "scene.toml").write_text(SCENE)
    row = {"faces": faces, "seconds": {}, "wrong": {}}
    for name, words in COMMANDS:
        row["seconds"][name], wrong = timed(gliss, words, folder, limit)
        if wrong:
            row["wrong"][name] = wrong
        print(f"  {name}: {row['seconds'][name]:.2f} s {wrong}", file=sys.stderr, flush=True)
    if "run" not in row["wrong"]:
        runs = [column(folder / "run.csv", "compute")]
        for _ in range(2):
            timed(gliss, RUN, folder, limit)
            runs.append(column(folder / "run.csv", "compute"))
        row["tick_us"] = 1e6 * max(min(map(float, tick)) for tick in zip(*runs))
        row["tick_evaluations"] = max(map(int, column(folder / "run.csv", "iterations")))
    return row


def table(rows):
    print("| mesh | faces | " + " | ".join(f"{name}, s" for name, _ in COMMANDS)
          + " | worst tick, evaluations | worst tick, us |")
    print("|---|" + "---|" * (len(COMMANDS) + 3))
    for name, row in rows.items():
        cells = [("over " if "over" == row["wrong"].get(c) else "failed " if c in row["wrong"] else "")
                 + f"{row['seconds'][c]:.2f}" for c, _ in COMMANDS]
        cells += [str(row.get("tick_evaluations", "–")), f"{row['tick_us']:.0f}" if "tick_us" in row else "–"]
        print(f"| {name} | {row['faces']} | " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss")
    parser.add_argument("--faces", type=int, default=40000)
    parser.add_argument("--only", default="", help="names of meshes, with commas between")
    parser.add_argument("--limit", type=float, default=120, help="s that a command may take")
    parser.add_argument("--json", type=pathlib.Path, help="file to write")
    options = parser.parse_args()
    rows = {}
    for name, (meaning, parts) in meshes(options.faces).items():
        if options.only and name not in options.only.split(","):
            continue
        print(f"{name}: {meaning}", file=sys.stderr, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            rows[name] = measured(os.path.abspath(options.gliss), parts, pathlib.Path(folder), options.limit)
    table(rows)
    worst = max(((row["seconds"][c], c, name) for name, row in rows.items() for c, _ in COMMANDS), default=None)
    if worst:
        print(f"\nThe slowest: {worst[1]} of {worst[2]}, {worst[0]:.1f} s, where {GOAL} s are the goal.")
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n")
    sys.exit(any(wrong for row in rows.values() for wrong in row["wrong"].values()) or (worst is not None and worst[0] > GOAL))


if __name__ == "__main__":
    main()
