#!/usr/bin/env python3
"""Drives the simulated device over the knot, and over the teeth where ../shared has them: with and without
stress-ng on all cores, sliding at 0.15 m/s and entering at 0.5 m/s.

Prints a table: success rate, missed periods, the largest step of the force sent and of the force as rendered, jumps
and lost contacts of the latter per 100,000 ticks in contact, the kick: what the force on touching has beyond stiffness
times that tick's way, at worst, and the lateness of the wakes.
Usage: bench/drive.py build/gliss [--seconds 60]
"""

import argparse
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tools"))
from slide_path import offset, resampled, surface_beneath  # noqa: E402
TEETH = HERE.parent.parent / "shared" / "meshes" / "teeth32_ngon.obj"
DEEP = 4.0  # mm that the hand aims beneath the surface; its grip of 300 N/m yields
ABOVE = 5.0  # mm above it, where the hand starts
STEP = 0.15  # mm a tick
STIFFNESS = 500  # N/m

SCENE = """
[[object]]
name = "{name}"
mesh = "{mesh}"
unit = "mm"
stiffness = "0.5N/mm"

[guards]
reengage = true

[sim]
path = "{path}"
interval = "1ms"
rounds = {rounds}
noise = "2um"
"""


def along_knot():
    """Points just above the knot, round it and back to the first."""
    import knot_path
    radius = knot_path.TUBE + 0.5
    count = 20000
    return [knot_path.point(2 * math.pi * i / count, radius) for i in range(count + 1)]


def along_teeth():
    """Points in front of the upper row, there and back."""
    count = 1000
    turns = [math.radians(75) * math.sin(2 * math.pi * i / count) for i in range(count + 1)]
    return [(34 * math.sin(a), 633.0, 98 + 46 * math.cos(a)) for a in turns]


def write_path(path, points):
    path.write_text("x_mm,y_mm,z_mm\n" + "".join("{},{},{}\n".format(*p) for p in points))


def paths_over(gliss, mesh, points, folder):
    feet = surface_beneath(gliss, mesh, points, folder)
    aim = resampled([offset(foot, DEEP) for foot in feet], STEP)
    wait = [offset(feet[0], -ABOVE)] * 700  # the guard's ramp
    write_path(folder / "slide.csv", wait + resampled([wait[0], aim[0]], STEP) + aim + aim[::-1])
    # In and out again, each time elsewhere.
    entries = []
    for foot in feet[::max(1, len(feet) // 20)]:
        way = resampled([offset(foot, -ABOVE), offset(foot, DEEP)], 0.5)
        entries += [way[0]] * 200 + way + [way[-1]] * 200 + way[::-1]
    write_path(folder / "enter.csv", [entries[0]] * 700 + entries)


def drive(gliss, name, mesh, path, seconds, folder):
    rows = len(path.read_text().splitlines()) - 1
    scene = folder / "scene.toml"
    scene.write_text(SCENE.format(name=name, mesh=mesh, path=path, rounds=max(1, math.ceil(seconds * 1000 / rows))))
    record = folder / "record.csv"
    done = subprocess.run([gliss, "run", scene, "--device", "sim", "--seconds", str(seconds), "--json", "--quiet",
                           "--record", record], check=True, stdout=subprocess.PIPE)
    return json.loads(done.stdout), entry_kick(record)


def entry_kick(record):
    """By how much the force sent on touching exceeds stiffness times the way of that tick, at worst, in N."""
    worst, last, was_free = 0.0, None, True
    with open(record, newline="") as file:
        for row in csv.DictReader(file):
            position = [float(row[k]) for k in ("x", "y", "z")]
            force = math.hypot(*(float(row[k]) for k in ("sent_x", "sent_y", "sent_z")))
            free = row["state"] == "free"
            if last and was_free and not free:
                worst = max(worst, force - STIFFNESS * math.dist(position, last))
            last, was_free = position, free
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss")
    parser.add_argument("--seconds", type=float, default=60)
    options = parser.parse_args()
    gliss = os.path.abspath(options.gliss)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        knot = folder / "knot.obj"
        subprocess.run([gliss, "generate", "knot", "-o", knot, "--quiet"], check=True)
        surfaces = [("knot", knot, along_knot())]
        if TEETH.exists():
            surfaces.append(("teeth", TEETH, along_teeth()))
        else:
            print("teeth: skipped, ../shared is not here")
        print(f"{'':24} {'success':>9} {'missed':>7} {'trips':>6} {'step sent, N':>13} {'rendered':>9} {'jumps/':>7} {'lost/':>6} "
              f"{'kick, N':>8} {'wake p99':>9} {'p99.9, us':>10} {'compute p99, us':>16}  scheduling")
        for surface, mesh, points in surfaces:
            paths_over(gliss, mesh, points, folder)
            for way in ("slide", "enter"):
                for stress in (False, True):
                    load = None
                    if stress:
                        load = subprocess.Popen(["stress-ng", "--quiet", "--cpu", str(os.cpu_count()), "--vm", "1",
                                                 "--vm-bytes", "256M", "--timeout", str(int(options.seconds) + 10)])
                    try:
                        seen, kick = drive(gliss, surface, mesh, folder / f"{way}.csv", options.seconds, folder)
                    finally:
                        if load:
                            load.terminate()
                            load.wait()
                    label = f"{surface}, {way}{', stress-ng' if stress else ''}"
                    print(f"{label:24} {100 * seen['success_rate']:8.3f}% {seen['missed']:7} {seen['guard_trips']:6} "
                          f"{seen['largest_sent_step']:13.4f} {seen['largest_force_step']:9.4f} "
                          f"{seen['jumps_per_100k']:7.1f} {seen['lost_per_100k']:6.1f} {kick:8.4f} "
                          f"{seen['wake']['p99_us']:9.0f} {seen['wake']['p999_us']:10.0f} "
                          f"{seen['compute']['p99_us']:16.1f}  {seen['scheduling']}", flush=True)
    print(f"a tick's way at 0.15 m/s is {STEP * 1e-3 * STIFFNESS:.3f} N, at 0.5 m/s {0.5e-3 * STIFFNESS:.3f} N")


if __name__ == "__main__":
    main()
