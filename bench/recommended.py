#!/usr/bin/env python3
"""What gliss compare recommends on meshes, and why, as a table of Markdown; and on how many it recommends a baseline.

Usage: bench/recommended.py GLISS FOLDER_OR_MESH... [--walks 8] [--seed 1] [--unit mm]

Double precision, without dense meshes. FOLDER holds .obj, .off, .ply and .stl files; the generated knot, goldberg and banana
come first. Jumps: of the recommended row and of flat and shaded, in 100,000 ticks over all walks, slow and fast, with settle and without.
"""

import argparse
import json
import subprocess
import sys
import tempfile

from walks import meshes_of


def jumps(row):
    walks = row["walks"]
    return sum(walk["jumps_per_100k"] for walk in walks) / len(walks)


def cells_of(mesh, options):
    """What is recommended and the cells of its row; or nothing and the error."""
    command = [options.gliss, "compare", mesh, "--unit", options.unit, "--precisions", "double", "--dense-limit", "0",
               "--ticks", "1000", "--walks", str(options.walks), "--seed", str(options.seed), "--json", "--quiet"]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        return None, ["refused", (ran.stderr.strip().splitlines() or ["failed"])[-1].replace("|", "/")]
    result = json.loads(ran.stdout)
    rows = {row["level"]: row for row in result["rows"]}
    best = result["recommended"] and result["recommended"]["level"]
    counts = [f"{jumps(rows[level]):.0f}" for level in (*([best] if best else []), "shaded", "flat")]
    return best, [best or "nothing", " / ".join(counts), result["reason"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("gliss")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--walks", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--unit", default="mm")
    options = parser.parse_args()
    baselines = meshes = 0
    print("| mesh | recommended | jumps: of it / shaded / flat | reason |\n|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for mesh in meshes_of(options.meshes, options.gliss, folder):
            best, cells = cells_of(mesh, options)
            meshes += best is not None
            baselines += best in ("flat", "shaded")
            print(f"| {mesh.stem} | " + " | ".join(cells) + " |", flush=True)
    print(f"\nA baseline is recommended on {baselines} of {meshes} meshes.")


if __name__ == "__main__":
    sys.exit(main())
