#!/usr/bin/env python3
"""Measures how cost grows: sweeps of the knot with ever more samples, projections with ever more HIPs, and ever finer
knots baked and loaded.

Prints a line a measurement, then tables: time per sample and per polygon, the peak memory of the process, bytes of a
cache per polygon, and what loading it costs beside reading its bytes, warm: into new memory, which a load has to take
too and which costs most on some machines, and into memory in place. Each is the best of 3 runs, or of as many as fit
into 1 s; what takes 5 s runs once. A load is all of `gliss eval` of one point, less what that takes on a cache of 8
faces. The last table has the time of each sample, HIP and polygon by threads, and with --mpi by ranks of one thread.
Ctrl-C and failures keep what is there.
Usage: bench/growth.py build/gliss [--samples 1e4:1e9] [--hips 1e4:1e7] [--faces 1e3:1e7] [--threads 1,2]
       [--mpi build/gliss-mpi --ranks 1,2] [--precision float] [--backend tbb] [--json growth.json]
"""

import argparse
import array
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tools"))
from bench_table import processor  # noqa: E402
REPEATS, AT_LEAST, LONG = 3, 1.0, 5.0  # runs, s of them together, s from which on one will do
DEPTHS = "2mm,4mm"
CHUNK = 1 << 16  # HIPs that are written together
KINDS = {"sweeps": "samples", "projections": "hips", "meshes": "polygons"}  # and what they are counted in
# Seconds into new memory, then into the same. A process of its own: a child's peak memory begins with its parent's.
READ = """
import mmap, os, sys, time
size = os.path.getsize(sys.argv[1])
for _ in range(int(sys.argv[2])):
    with open(sys.argv[1], "rb", buffering=0) as file, mmap.mmap(-1, size) as pages, memoryview(pages) as memory:
        for _ in range(2):
            start, done = time.perf_counter(), 0
            file.seek(0)
            while done < size:
                done += file.readinto(memory[done:])
            print(time.perf_counter() - start)
"""


def decades(text):
    first, _, last = text.partition(":")
    first, last = float(first), float(last or first)
    if not 1 <= first <= last < math.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is not a range of sizes, as 1e3:1e5")
    return [round(first * 10 ** i) for i in range(math.floor(math.log10(last / first) + 1e-9) + 1)]


def measured(words):
    """What the command prints, and the time and peak memory of its process."""
    start = time.perf_counter()
    child = subprocess.Popen(words, stdout=subprocess.PIPE)
    try:
        printed = child.stdout.read()
        _, status, usage = os.wait4(child.pid, 0)
    except KeyboardInterrupt:
        child.terminate()
        child.wait()
        raise
    seconds = time.perf_counter() - start
    child.stdout.close()
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        raise subprocess.CalledProcessError(child.returncode, words)
    return printed, {"process_seconds": seconds, "cpu_seconds": usage.ru_utime + usage.ru_stime,
                     "peak_bytes": usage.ru_maxrss * 1024}


def best(words):
    """Of its fastest run: the figures that it prints, and those of the process."""
    runs, spent = [], 0.0
    while (len(runs) < REPEATS or spent < AT_LEAST) and spent < LONG * max(1, len(runs)):
        printed, process = measured(words)
        figures = json.loads(printed) if "--json" in words else {"seconds": process["process_seconds"]}
        runs.append(figures | process)
        spent += process["process_seconds"]
    return min(runs, key=lambda run: run["seconds"])


class Bench:
    def __init__(self, gliss, backend, precision, folder, ways):
        self.gliss, self.backend, self.precision = os.path.abspath(gliss), backend, precision
        self.ways = ways
        self.folder = folder
        self.point = folder / "point.csv"
        self.point.write_text("face,xi,eta\n0,0,0\n")

    def run(self, command, *words):
        return best([self.gliss, command, *map(str, words), "--backend", self.backend, "--quiet"])

    def seconds_by_way(self, command, *words):
        """Of the process; None where a way has no such command."""
        words = [command, *map(str, words), "--backend", self.backend, "--quiet"]
        return {name: best([*start, *words, *end])["process_seconds"]
                for name, start, end, commands in self.ways if command in commands}

    def made(self, shape, *words):
        mesh = self.folder / f"{shape}.obj"
        printed, _ = measured([self.gliss, "generate", shape, *map(str, words), "-o", mesh, "--quiet", "--json"])
        return mesh, json.loads(printed)["faces"]

    def baked(self, mesh):
        cache = mesh.with_suffix(".gliss")
        return cache, self.run("bake", mesh, "--unit", "mm", "--precision", self.precision, "-o", cache, "--json")

    def opened(self, cache):
        return self.run("eval", cache, "--at", self.point, "-o", self.folder / "eval.csv")["seconds"]


def ways_of(options):
    """Each a name, the words before a command and behind it, and the commands that it has."""
    gliss = os.path.abspath(options.gliss)
    ways = [(f"{n} threads", [gliss], ["--threads", n], ("bake", "sweep", "project")) for n in options.threads]
    if options.mpi:
        mpi = os.path.abspath(options.mpi)
        root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        ways += [(f"{n} ranks", ["mpirun", *root, "--oversubscribe", "-n", n, mpi], ["--threads", "1"],
                  ("sweep", "project")) for n in options.ranks]
    return ways


def of_process(figures):
    return {key: figures[key] for key in ("process_seconds", "cpu_seconds", "peak_bytes")}


def read_seconds(path):
    """Into new memory, and into memory that is there."""
    printed, _ = measured([sys.executable, "-c", READ, path, str(REPEATS)])
    seconds = [float(text) for text in printed.split()]
    return min(seconds[::2]), min(seconds[1::2])


def knot_of(polygons):
    """Words that ask for about so many, ten times as many along as around like the generator's default."""
    around = max(3, round(math.sqrt(polygons / 10)))
    return "--along", max(3, round(polygons / around)), "--around", around


def sweeps(bench, sizes, rows):
    mesh, _ = bench.made("knot")
    cache, _ = bench.baked(mesh)
    depths = DEPTHS.count(",") + 1
    for size in sizes:
        seen = bench.run("sweep", cache, "--depth", DEPTHS, "--samples", math.ceil(size / depths), "--json")
        samples = seen["samples_per_depth"] * depths
        rows.append({"samples": samples, "contacts": round(seen["contacts_per_second"] * seen["seconds"]),
                     "seconds": seen["seconds"], "ns_per_sample": 1e9 * seen["seconds"] / samples,
                     **of_process(seen)})
        print(f"sweep of {samples} samples: {seen['seconds']:.3f} s", flush=True)
        rows[-1]["by_way"] = bench.seconds_by_way("sweep", cache, "--depth", DEPTHS, "--samples",
                                                  math.ceil(size / depths), "--summary", bench.folder / "s.json")


def projections(bench, sizes, rows):
    """Of HIPs 2 mm beneath a torus as large as the knot's bounds, in the order of a walk."""
    mesh, _ = bench.made("knot")
    cache, _ = bench.baked(mesh)
    for size in sizes:
        hips = bench.folder / "hips.npy"
        with open(hips, "wb") as file:
            header = repr({"descr": "<f8", "fortran_order": False, "shape": (size, 3)}).encode().ljust(117) + b"\n"
            file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header)
            for begin in range(0, size, CHUNK):
                at = [2 * math.pi * i / size for i in range(begin, min(size, begin + CHUNK))]
                file.write(array.array("d", (x for t in at for x in (
                    20 * math.cos(3 * t), 20 * math.sin(3 * t), 8 * math.sin(1000 * t)))).tobytes())
        by_way = bench.seconds_by_way("project", cache, "--unit", "mm", "--hip", hips, "-o", bench.folder / "near.h5")
        rows.append({"hips": size, "by_way": by_way})
        print(f"projection of {size} HIPs: " + ", ".join(f"{s:.3f} s by {n}" for n, s in by_way.items()), flush=True)


def meshes(bench, sizes, rows):
    small, _ = bench.baked(bench.made("prism")[0])
    start = bench.opened(small)
    for size in sizes:
        mesh, polygons = bench.made("knot", *knot_of(size))
        cache, seen = bench.baked(mesh)
        read_new, read = read_seconds(cache)
        load = bench.opened(cache) - start
        rows.append({"polygons": polygons, "bake_seconds": seen["seconds"],
                     "us_per_polygon": 1e6 * seen["seconds"] / polygons, **of_process(seen),
                     "cache_bytes": cache.stat().st_size,
                     "load_seconds": load if load > 0 else None,  # too short to tell
                     "read_new_seconds": read_new, "read_seconds": read})
        rows[-1]["by_way"] = bench.seconds_by_way("bake", mesh, "--unit", "mm", "--precision", bench.precision, "-o",
                                                  cache)
        print(f"knot of {polygons} polygons: baked in {seen['seconds']:.3f} s, loaded in {load:.4f} s, "
              f"read in {read_new:.4f} s into new memory, {read:.4f} s into old", flush=True)


def tables(growth):
    if growth["sweeps"]:
        print(f"\n{'samples':>12} {'s':>9} {'samples/s':>10} {'ns each':>9} {'peak MiB':>9}")
    for r in growth["sweeps"]:
        print(f"{r['samples']:12} {r['seconds']:9.3f} {r['samples'] / r['seconds']:10.3g} {r['ns_per_sample']:9.0f} "
              f"{r['peak_bytes'] / 2**20:9.1f}")
    if growth["meshes"]:
        print(f"\n{'polygons':>12} {'bake, s':>9} {'us each':>9} {'peak B each':>12} {'cache B each':>13} "
              f"{'load, s':>9} {'read new, s':>12} {'load/it':>8} {'read old, s':>12} {'load/it':>8}")
    for r in growth["meshes"]:
        n, load = r["polygons"], r["load_seconds"] or math.nan
        new, old = r["read_new_seconds"], r["read_seconds"]
        print(f"{n:12} {r['bake_seconds']:9.3f} {r['us_per_polygon']:9.2f} {r['peak_bytes'] / n:12.0f} "
              f"{r['cache_bytes'] / n:13.0f} {load:9.4f} {new:12.4f} {load / new:8.2f} {old:12.4f} {load / old:8.2f}")


    names = list(dict.fromkeys(n for kind in KINDS for r in growth[kind] for n in r.get("by_way", {})))
    print("\nof whole processes, us each" + "".join(f"{name:>12}" for name in names))
    for kind, size in KINDS.items():
        for r in growth[kind]:
            ways = r.get("by_way", {})
            cells = (f"{1e6 * ways[n] / r[size]:12.3f}" if n in ways else f"{'-':>12}" for n in names)
            print(f"{r[size]:>15} {size:<11}" + "".join(cells))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss")
    parser.add_argument("--samples", type=decades, default="1e4:1e7", help="of sweeps, by decades; default 1e4:1e7")
    parser.add_argument("--hips", type=decades, default="1e4:1e6", help="of projections; default 1e4:1e6")
    parser.add_argument("--faces", type=decades, default="1e3:1e5", help="of knots, by decades; default 1e3:1e5")
    parser.add_argument("--threads", type=lambda text: text.split(","), default=["1", "2"], help="default 1,2")
    parser.add_argument("--mpi", help="the program gliss-mpi, to measure ranks too")
    parser.add_argument("--ranks", type=lambda text: text.split(","), default=["1", "2"], help="default 1,2")
    parser.add_argument("--precision", choices=["float", "double"], default="double")
    parser.add_argument("--backend", default="tbb")
    parser.add_argument("--json", type=pathlib.Path, help="file to write, for gliss report")
    options = parser.parse_args()
    version, _ = measured([options.gliss, "--version"])
    growth = {"machine": f"{os.cpu_count()} cores of {processor()}", "gliss": version.decode().split()[-1],
              "backend": options.backend, "precision": options.precision, "sweeps": [], "projections": [],
              "meshes": []}
    stopped = None
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(options.gliss, options.backend, options.precision, pathlib.Path(name), ways_of(options))
        try:
            sweeps(bench, options.samples, growth["sweeps"])
            projections(bench, options.hips, growth["projections"])
            meshes(bench, options.faces, growth["meshes"])
        except KeyboardInterrupt:
            stopped = 130
        except subprocess.CalledProcessError as error:  # out of memory, say
            stopped = str(error)
    tables(growth)
    if options.json:
        options.json.write_text(json.dumps({"growth": growth}, indent=2) + "\n")
    sys.exit(stopped)


if __name__ == "__main__":
    main()
