#!/usr/bin/env python3
"""How often the force jumps on random walks beneath meshes, as a table of Markdown: Gregory patches
(paper and paper-bezier, fair) beside force shading and flat polygons, 0.5 % and
0.1 % of the size deep, slow (5 mm/s on a mesh of 100 mm, in a loop of 1 kHz) and ten times as fast, without
settle and with it.

Usage: bench/walks.py GLISS FOLDER_OR_MESH... [--ticks 100000] [--seed 1] [--step 1%] [--unit mm] [--settle 5ms]
                      [--found]

GLISS is the program; FOLDER holds .obj, .off, .ply and .stl files; the generated knot, goldberg and banana
come first, unless --found leaves them out. Counts are ticks whose force changes by more than 20 % of stiffness times depth, contacts
lost under more than that included, per 100,000 ticks in contact (host/walk/walk.h), ± one standard deviation
over seeds; all surfaces of a mesh get the same HIPs. Bold: more often than force shading by more than the spread
of the two. Beyond: steps above twice the way of the hand, as often; slid: the share of ticks in contact that slide; lost
contacts: each paper / fair / shaded / flat. Loops: the work that closed loops a face wide give the hand, at most, in % of
force times way; "<": less than its error. Held: contacts that outlive their touch, of how many (docs/levels.md, Hands
that leave; of any depth). Both with settle, once a mesh.
"""

import argparse
import collections
import json
import math
import pathlib
import subprocess
import sys
import tempfile

PATCHES = ("paper", "paper-bezier", "fair")
LEVELS = PATCHES + ("shaded", "flat")
DEPTHS = ("0.5%", "0.1%")
MOST = tuple(level for level in LEVELS if level != "paper-bezier")
TICKS_A_WALK = 2500
GENERATED = ("knot", "goldberg", "banana")


def meshes_of(names, gliss, folder, generated=GENERATED):
    for name in generated:
        path = pathlib.Path(folder) / f"generated {name}.obj"
        subprocess.run([gliss, "generate", name, "-o", path, "--quiet"], check=True)
        yield path
    for name in map(pathlib.Path, names):
        yield from sorted(p for p in name.iterdir() if p.suffix in (".obj", ".off", ".ply", ".stl")) \
            if name.is_dir() else [name]


def compare(mesh, depth, options):
    """The rows by level; or the error of a mesh that is refused."""
    command = [options.gliss, "compare", mesh, "--unit", options.unit, "--levels", ",".join(LEVELS),
               "--precisions", "double", "--dense-limit", "0", "--ticks", "100", "--json", "--quiet",
               "--walks", str(options.ticks // TICKS_A_WALK), "--walk-ticks", str(TICKS_A_WALK),
               "--walk-depth", depth, "--walk-step", options.step, "--seed", str(options.seed),
               "--settle", options.settle]
    if depth != DEPTHS[0]:
        command += ["--leaving", "0"]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        told = ran.stderr.strip().splitlines() or ["failed"]
        return None, "refused: " + told[-1].removeprefix("gliss: ").replace(str(mesh), mesh.name)
    return {row["surface"]: row for row in json.loads(ran.stdout)["rows"]}, None


def beside(felt, shaded):
    """1 if it jumps more often by more than the spread of the two, -1 if less often, else 0."""
    difference = felt["jumps_per_100k"] - shaded["jumps_per_100k"]
    spread = math.hypot(felt["jumps_spread_per_100k"], shaded["jumps_spread_per_100k"])
    return (difference > spread) - (difference < -spread)


def jumps(walks, level):
    felt = walks[level]
    text = f"{felt['jumps_per_100k']:.1f} ± {felt['jumps_spread_per_100k']:.1f}"
    return f"**{text}**" if level in PATCHES and beside(felt, walks["shaded"]) > 0 else text


def felt_cells(rows, condition):
    """Of one depth, speed and settle."""
    walks = {level: rows[level]["walks"][condition] for level in LEVELS}
    most = lambda key, scale, digits: " / ".join(f"{scale * walks[level][key]:.{digits}f}" for level in MOST)
    return [jumps(walks, level) for level in LEVELS] + [
        most("lost_per_100k", 1, 1), most("steps_beyond_2dx_per_100k", 1, 1), most("settling_share", 100, 2)]


def loops(row):
    gain, error = row["loop_gain"], row["loop_gain_error"]
    if gain is None:
        return "–"
    return f"{100 * gain:.1g}" if abs(gain) > error else f"<{100 * error:.0g}"


def mesh_cells(rows):
    return [" / ".join(loops(rows[level]) for level in MOST),
            " / ".join(f"{rows[level]['held_outside']} of {rows[level]['held_outside_of']}" for level in MOST)]


def rows_of(mesh, options, standings):
    """The rows of a mesh: each a name and its cells."""
    by_depth = []
    for depth in DEPTHS:
        rows, told = compare(mesh, depth, options)
        if rows is None:
            yield mesh.stem, [told.replace("|", "/")]
            return
        by_depth.append(rows)
    for condition, walk in enumerate(by_depth[0]["fair"]["walks"]):
        cells = [cell for rows in by_depth for cell in felt_cells(rows, condition)]
        for depth, rows in zip(DEPTHS, by_depth):
            speed = "slow" if condition < 2 else "fast"
            walks = [rows[level]["walks"][condition] for level in ("fair", "shaded")]
            standings.setdefault((depth, speed, walk["settle_s"]), collections.Counter())[beside(*walks)] += 1
        name = f"{mesh.stem}, {walk['mm_per_s_at_1kHz']:.3g} mm/s, settle {1000 * walk['settle_s']:g} ms"
        yield name, cells + (mesh_cells(by_depth[0]) if condition == 0 else ["", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("gliss")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--ticks", type=int, default=100000, help="of each row")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--step", default="1%", help="of the depth, a tick")
    parser.add_argument("--unit", default="mm")
    parser.add_argument("--settle", default="5ms", help="of the rows that settle")
    parser.add_argument("--found", action="store_true", help="the named meshes alone, no generated ones")
    options = parser.parse_intermixed_args()
    standings = {}  # by depth, speed and settle: on how many meshes fair is `beside` shading so
    head = [f"{depth}: {name}" for depth in DEPTHS for name in LEVELS + ("lost", "beyond", "slid, %")]
    head += ["loops, %", "held"]
    print("| mesh, speed at the first depth | " + " | ".join(head) + " |\n|---|" + "---|" * len(head), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        generated = () if options.found else GENERATED
        for mesh in meshes_of(options.meshes, options.gliss, folder, generated):
            for name, cells in rows_of(mesh, options, standings):
                print(f"| {name} | " + " | ".join(cells) + " |", flush=True)
    print("\nJumps of fair patches beside force shading, by more than the spread of the two:\n")
    print("| depth | hand | settle | meshes with fewer | alike | with more |\n|---|---|---|---|---|---|")
    for (depth, speed, settle), meshes in standings.items():
        print(f"| {depth} | {speed} | {1000 * settle:g} ms | {meshes[-1]} | {meshes[0]} | {meshes[1]} |")


if __name__ == "__main__":
    sys.exit(main())
