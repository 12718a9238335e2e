#!/usr/bin/env python3
"""How long each command keeps a user waiting on a mesh: the longest silence on a terminal, and Ctrl-C at random moments.

Goals: half a second each, on an idle machine. HIPs and points lie about the vertices of the mesh. A command that takes
longer than --limit seconds is ended: its silence counts, and Ctrl-C comes within that time.
Usage: bench/waiting.py build/gliss MESH.obj [--unit mm] [--hips 2000] [--points 1000000] [--only eval,trace]
"""

import argparse
import os
import pathlib
import pty
import random
import select
import signal
import subprocess
import tempfile
import time


def read_obj(path):
    """Vertices, and the number of faces."""
    lines = path.read_text().splitlines()
    return ([tuple(map(float, line.split()[1:4])) for line in lines if line.startswith("v ")],
            sum(line.startswith("f ") for line in lines))


def write_inputs(folder, vertices, faces, hips, points):
    rng = random.Random(1)
    sizes = [max(axis) - min(axis) for axis in zip(*vertices)]
    with (folder / "hips.csv").open("w") as file:
        file.write("x,y,z\n")
        for _ in range(hips):
            file.write("%r,%r,%r\n" % tuple(x + rng.gauss(0, 0.01) * s for x, s in zip(rng.choice(vertices), sizes)))
    with (folder / "points.csv").open("w") as file:
        file.write("face,xi,eta\n")
        for _ in range(points):
            file.write("%d,%r,%r\n" % (rng.randrange(faces), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3)))
    return 0.005 * sum(s * s for s in sizes) ** 0.5


def watched(words, folder, limit, interrupt_at=None):
    """Seconds it took, its longest silence, and seconds from Ctrl-C to its end; None where none came."""
    here, there = pty.openpty()
    start = last = time.monotonic()
    ran = subprocess.Popen(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=there)
    os.close(there)
    silence, sent = 0, None
    while ran.poll() is None:
        if select.select([here], [], [], 0.01)[0]:
            try:
                os.read(here, 65536)
            except OSError:  # the other end is closed
                break
            silence, last = max(silence, time.monotonic() - last), time.monotonic()
        if time.monotonic() - start > (limit if interrupt_at is None else interrupt_at) and sent is None:
            sent = time.monotonic()
            ran.send_signal(signal.SIGINT)
    ran.wait()
    end = time.monotonic()
    os.close(here)
    return end - start, max(silence, (sent or end) - last), end - sent if sent else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss")
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("--unit", default="mm")
    parser.add_argument("--hips", type=int, default=2000)
    parser.add_argument("--points", type=int, default=1000000)
    parser.add_argument("--limit", type=float, default=30)
    parser.add_argument("--only", default="", help="commands, parted by commas")
    options = parser.parse_args()

    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        depth = write_inputs(folder, *read_obj(options.mesh), options.hips, options.points)
        commands = {
            "check": [], "info": [], "bake": ["-o", "m.gliss"],
            "project": ["--hip", "hips.csv", "-o", "n.csv"], "eval": ["--at", "points.csv", "-o", "e.csv"],
            "trace": ["--path", "hips.csv", "-o", "t.csv"],
            "sweep": ["--depth", f"{depth!r}{options.unit}", "--samples", "20000", "-o", "s.h5", "--parts", "none"],
            "compare": ["--walks", "2"]}
        print(f"{options.mesh.name}\n| command | s | longest silence, s | Ctrl-C, worst of 5, s |\n|---|---|---|---|")
        rng = random.Random(2)
        for name, further in commands.items():
            if options.only and name not in options.only.split(","):
                continue
            words = [os.path.abspath(options.gliss), name, str(options.mesh.resolve()), "--unit", options.unit, *further]
            took, silence, late = watched(words, folder, options.limit)
            ends = [watched(words, folder, options.limit, rng.uniform(0.02, 0.95) * took)[2] for _ in range(5)]
            worst = max([end for end in [late, *ends] if end is not None], default=0)
            print(f"| {name} | {'over ' if late else ''}{took:.2f} | {silence:.2f} | {worst:.2f} |", flush=True)


if __name__ == "__main__":
    main()
