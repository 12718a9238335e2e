#!/usr/bin/env python3
"""Counts contacts that are held after the hand has left, as a table of Markdown: hands that press in anywhere, slide,
leave and rest outside (docs/levels.md, Hands that leave), for settle 0, 5 and 20 ms.

Usage: bench/leaving.py GLISS FOLDER_OR_MESH... [--contacts 20000] [--settle 0,5ms,20ms] [--levels fair] [--creases]
                        [--precision double] [--seed 1] [--unit mm]

GLISS is the program; FOLDER holds .obj, .off, .ply and .stl files; the generated knot, goldberg, banana, plate and fin come
first. --contacts is the number over all meshes and one settle: a million take hours. A row is printed as soon as its mesh
is done, and the sum after each: what is interrupted has said what it found. Cells: held contacts of all, the longest time in
ms, and the ticks that pull against the contact's normal.
"""

import argparse
import json
import subprocess
import sys
import tempfile

from walks import GENERATED, meshes_of

HANDS = 1000  # of one run of the program


def run(mesh, settle, hands, seed, options):
    """The rows by level, or the error of a mesh that is refused."""
    command = [options.gliss, "compare", mesh, "--unit", options.unit, "--levels", options.levels,
               "--precisions", options.precision, "--dense-limit", "0", "--ticks", "100", "--json", "--quiet",
               "--walks", "0", "--leaving", str(hands), "--seed", str(seed), "--settle", settle]
    ran = subprocess.run(command + (["--crease", "auto"] if options.creases else []), capture_output=True, text=True)
    if ran.returncode != 0:
        return None, (ran.stderr.strip().splitlines() or ["failed"])[-1]
    return {row["level"]: row for row in json.loads(ran.stdout)["rows"]}, None


class Count:
    def __init__(self):
        self.held = self.contacts = self.pulled = 0
        self.longest = 0.0

    def add(self, held, contacts, pulled, longest):
        self.held += held
        self.contacts += contacts
        self.pulled += pulled
        self.longest = max(self.longest, longest)

    def __str__(self):
        return f"{self.held} of {self.contacts}, {1e3 * self.longest:.0f} ms, {self.pulled}"


def count_mesh(mesh, settle, contacts, options):
    """By level; or the error. Goes on until each level has that many contacts, or hands touch nothing."""
    counts, seed = {level: Count() for level in options.levels.split(",")}, options.seed
    while min(c.contacts for c in counts.values()) < contacts:
        left = contacts - min(c.contacts for c in counts.values())
        rows, told = run(mesh, settle, min(HANDS, left), seed, options)
        if rows is None:
            return None, told
        for level, row in rows.items():
            if row["held_outside_of"] is None:
                return None, "hands touch nothing"
            counts[level].add(row["held_outside"], row["held_outside_of"], row["held_outside_pulled"],
                              row["held_outside_longest"])
        seed += 1
    return counts, None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("gliss")
    parser.add_argument("meshes", nargs="*")
    parser.add_argument("--contacts", type=int, default=20000, help="over all meshes, of each settle")
    parser.add_argument("--settle", default="0,5ms,20ms")
    parser.add_argument("--levels", default="fair")
    parser.add_argument("--precision", default="double", choices=("float", "double"))
    parser.add_argument("--creases", action="store_true", help="as --crease auto finds them")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--unit", default="mm")
    options = parser.parse_args()
    settles, levels = options.settle.split(","), options.levels.split(",")
    heads = [f"{level}, settle {settle}" for settle in settles for level in levels]
    sums = {head: Count() for head in heads}
    print("| mesh | " + " | ".join(heads) + " |\n|---|" + "---|" * len(heads), flush=True)
    try:
        with tempfile.TemporaryDirectory() as folder:
            meshes = list(meshes_of(options.meshes, options.gliss, folder,
                                    GENERATED + ("plate", "fin")))
            for mesh in meshes:
                cells = []
                for settle in settles:
                    counts, told = count_mesh(mesh, settle, -(-options.contacts // len(meshes)), options)
                    if counts is None:
                        cells = [told.removeprefix("gliss: ").replace(str(mesh), mesh.name).replace("|", "/")]
                        break
                    for level in levels:
                        c = counts[level]
                        sums[f"{level}, settle {settle}"].add(c.held, c.contacts, c.pulled, c.longest)
                        cells.append(str(c))
                print(f"| {mesh.stem} | " + " | ".join(cells) + " |", flush=True)
    except KeyboardInterrupt:
        print("| interrupted |", flush=True)
    print("| all | " + " | ".join(str(sums[head]) for head in heads) + " |")


if __name__ == "__main__":
    sys.exit(main())
