#!/usr/bin/env python3
"""How often the force jumps on random walks beneath meshes, as a table of Markdown: Gregory patches
(exact and bezier of the paper's construction, fair) beside force shading and flat polygons, 0.5 % and
0.1 % of the size deep.

Usage: bench/walks.py GLISS FOLDER_OR_MESH... [--ticks 100000] [--seed 1] [--step 1%] [--unit mm] [--settle 5ms]
                      [--speeds 5,50]

GLISS is the program; FOLDER holds .obj, .off and .ply files; the generated knot, goldberg and banana
come first. Counts are ticks whose force changes by more than 20 % of stiffness times depth, contacts
lost under more than that included, per 100,000 ticks in contact (host/study/walk.h); all surfaces of a mesh
get the same HIPs. Bold: more often than force shading. Lost contacts and largest steps: exact / fair.
Loops: the work that closed loops a face wide give the hand, at most, in % of the work done along them: exact /
fair / shaded / flat. Beyond: steps above twice the way of the hand, as often as jumps are told. Held: contacts that outlive their touch,
of how many (docs/levels.md, Hands that leave; of any depth, so once a row): exact / fair / shaded / flat. With --speeds, in mm/s for a mesh
whose diagonal is 100 mm and a loop of 1 kHz, each mesh has a row at each speed without --settle and one with it. With --settle, leaps are slides, and the last column is the share of ticks in contact that slide: exact / fair
/ shaded / flat.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

PATCHES = ("exact", "bezier", "fair")
LEVELS = PATCHES + ("shaded", "flat")
DEPTHS = ("0.5%", "0.1%")
MOST = tuple(level for level in LEVELS if level != "bezier")
TICKS_A_WALK = 2500
STIFFNESS = 500  # N/m


def meshes_of(names, gliss, folder, more=()):
    for name in ("knot", "goldberg", "banana", *more):
        path = pathlib.Path(folder) / f"generated {name}.obj"
        subprocess.run([gliss, "generate", name, "-o", path, "--quiet"], check=True)
        yield path
    for name in map(pathlib.Path, names):
        yield from sorted(p for p in name.iterdir() if p.suffix in (".obj", ".off", ".ply", ".stl")) \
            if name.is_dir() else [name]


def compare(mesh, depth, step, settle, options):
    """The rows by level and the depth in m; or the error of a mesh that is refused."""
    command = [options.gliss, "compare", mesh, "--unit", options.unit, "--levels", ",".join(LEVELS),
               "--precisions", "double", "--dense-limit", "0", "--ticks", "100", "--json", "--quiet",
               "--walks", str(options.ticks // TICKS_A_WALK), "--walk-ticks", str(TICKS_A_WALK),
               "--walk-depth", depth, "--walk-step", step, "--seed", str(options.seed),
               "--stiffness", str(STIFFNESS), "--settle", settle]
    if depth != DEPTHS[0]:
        command += ["--leaving", "0"]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        told = ran.stderr.strip().splitlines() or ["failed"]
        return None, "refused: " + told[-1].removeprefix("gliss: ").replace(str(mesh), mesh.name)
    result = json.loads(ran.stdout)
    return {row["level"]: row for row in result["rows"]}, result["walks"]["depth_m"]


def largest(step, depth):
    return "not finite" if step is None else f"{step / (STIFFNESS * depth):.1f}"


def step_at(speed, depth):
    """The share of the depth, which is one of the diagonal, that a tick of 1 ms is of a speed in mm/s."""
    return f"{speed / 10 / float(depth.removesuffix('%')):g}%"


def cells(rows, depth, settle):
    limit = rows["shaded"]["jumps_per_100k"]
    for level in LEVELS:
        jumps = rows[level]["jumps_per_100k"]
        worse = level in PATCHES and jumps > limit
        yield f"**{jumps:.1f}**" if worse else f"{jumps:.1f}"
    yield " / ".join(f"{rows[level]['lost_per_100k']:.1f}" for level in ("exact", "fair"))
    yield " / ".join(largest(rows[level]["walk_max_force_step"], depth) for level in ("exact", "fair"))
    yield " / ".join("–" if rows[level]["loop_gain"] is None else f"{100 * rows[level]['loop_gain']:.1g}"
                     for level in MOST)
    yield " / ".join(f"{rows[level]['steps_beyond_2dx_per_100k']:.1f}" for level in MOST)
    if settle:
        yield " / ".join(f"{100 * rows[level]['settling_share']:.2f}" for level in MOST)


def held(rows):
    return " / ".join(f"{rows[level]['held_outside']} of {rows[level]['held_outside_of']}" for level in MOST)


def row_of(mesh, steps, settle, slid, options):
    found, left = [], []
    for depth, step in zip(DEPTHS, steps):
        rows, told = compare(mesh, depth, step, settle, options)
        if rows is None:
            return [told.replace("|", "/")]
        left = left or [held(rows)]
        found += cells(rows, told, slid)
    return found + left


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("gliss")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--ticks", type=int, default=100000, help="of each row")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--step", default="1%", help="of the depth, a tick")
    parser.add_argument("--unit", default="mm")
    parser.add_argument("--settle", default="0", help="time constant of slides in place of leaps, as 5ms")
    parser.add_argument("--speeds", type=lambda text: [float(s) for s in text.split(",")], default=[],
                        help="mm/s for a mesh of 100 mm, in place of --step: rows without --settle and with it")
    options = parser.parse_args()
    slid = options.settle != "0"
    ways = [("", (options.step,) * len(DEPTHS), options.settle)]
    if options.speeds:
        ways = [(f", {speed:g} mm/s, settle {settle}", [step_at(speed, depth) for depth in DEPTHS], settle)
                for speed in options.speeds for settle in dict.fromkeys(("0", options.settle))]
    head = [f"{depth}: {name}" for depth in DEPTHS
            for name in LEVELS + ("lost", "largest, k d", "loops, %", "beyond") + (("slid, %",) if slid else ())] + ["held"]
    print("| mesh | " + " | ".join(head) + " |\n|---|" + "---|" * len(head), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for mesh in meshes_of(options.meshes, options.gliss, folder):
            for told, steps, settle in ways:
                found = row_of(mesh, steps, settle, slid, options)
                print(f"| {mesh.stem}{told} | " + " | ".join(found) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
