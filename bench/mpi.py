#!/usr/bin/env python3
"""Measures what ranks are worth: sweeps of the knot and projections of HIPs beneath it by gliss on one and on all threads, and by
gliss-mpi on one rank and on as many ranks of one thread as there are cores, in turns.

Prints a line a measurement and two tables: seconds of a whole command and those that processors worked for it, which tell
more where others use them too, of --repeats the median, of sweeps with statistics alone (--summary) and with samples (-o), and of
projections; and where the seconds of the ranks went: parts, the counter, and rank 0 at waiting and at the result. From these it fits a model, and prints what it says of --ranks ranks and --large samples.
Usage: bench/mpi.py build/gliss build/gliss-mpi [--samples 1e6,1e7] [--repeats 3] [--ranks 1000] [--large 1e12]
       [--layout compact] [--mpirun "mpirun --oversubscribe"]
"""

import argparse
import json
import math
import os
import pathlib
import resource
import shlex
import statistics
import subprocess
import tempfile
import time

import numpy

SWEEP = ["sweep", "knot.gliss", "--depth", "2mm,4mm", "--samples"]  # half as many as HIPs
OUTPUTS = {"statistics": "--summary s.json", "samples": "-o s.h5", "projections": "-o p.h5"}
METHODS = {"statistics": 3, "samples": 3, "projections": 1}


def processor_seconds():
    """Of all children so far, and of theirs."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Bench:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        # Root may not run mpirun without these, and containers forbid what the third is about.
        self.environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                                OMPI_MCA_btl_vader_single_copy_mechanism="none")
        for words in (["generate", "knot", "-o", "knot.obj"], ["bake", "knot.obj", "--unit", "mm", "-o", "knot.gliss"]):
            self.run([options.gliss, *words, "--quiet"])

    def run(self, words):
        """Seconds, those of processors, and what it prints."""
        used, start = processor_seconds(), time.perf_counter()
        out = subprocess.run(words, cwd=self.folder, env=self.environment, check=True, capture_output=True, text=True)
        return time.perf_counter() - start, processor_seconds() - used, out.stdout

    def place_hips(self, count):
        """As many HIPs, in a file of their own: those of a sweep."""
        samples, hips = self.folder / "s.npy", self.folder / f"hips_{count}.npy"
        if hips.exists():
            return hips.name
        self.run([self.options.gliss, *SWEEP, str(math.ceil(count / 2)), "--method", "flat", "--unit", "mm", "-o", "s.npy"])
        swept = numpy.load(samples, mmap_mode="r")[:count]
        numpy.save(hips, numpy.stack([swept[f"hip_{axis}"] for axis in "xyz"], axis=1).astype(float))
        samples.unlink()
        return hips.name

    def measure(self, hips, output, threads, ranks):
        launch = [*shlex.split(self.options.mpirun), "-n", str(ranks), self.options.gliss_mpi] if ranks else [
            self.options.gliss]
        work = (["project", "knot.gliss", "--unit", "mm", "--hip", self.place_hips(hips)] if output == "projections" else
                [*SWEEP, str(math.ceil(hips / 2))])
        seconds, used, out = self.run([*launch, *work, "--threads", str(threads), *OUTPUTS[output].split(), "--json"])
        return {**json.loads(out), "whole": seconds, "used": used}


def median(runs):
    """The run in the middle."""
    return sorted(runs, key=lambda run: run["whole"])[len(runs) // 2]


def model(startup, at, ranks, contacts):
    """Seconds of a command by so many ranks, by what each of them does."""
    parts = math.ceil(contacts / at["part_contacts"])
    return {"parts": parts,
            "start": startup,
            "contacts": contacts * at["contact"] / ranks,
            "last part": at["part_contacts"] * at["contact"],
            "counter": parts * at["ask"] / ranks,
            "result, at the same time": parts * at["write"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gliss", type=os.path.abspath)
    parser.add_argument("gliss_mpi", type=os.path.abspath)
    parser.add_argument("--samples", default="1e6,1e7", help="HIPs, of a sweep over both depths; default 1e6,1e7")
    parser.add_argument("--outputs", default=",".join(OUTPUTS), help="which; default all")
    parser.add_argument("--layout", default="compact", help="of samples: compact or plain")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--ranks", type=float, default=1000, help="of the model")
    parser.add_argument("--large", type=float, default=1e12, help="HIPs of the model")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe")
    options = parser.parse_args()
    OUTPUTS["samples"] += f" --layout {options.layout}"
    cores = len(os.sched_getaffinity(0))
    kinds = {"1 thread": (1, 0), f"{cores} threads": (cores, 0), "1 rank": (1, 1), f"{cores} ranks": (1, cores)}
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options, pathlib.Path(folder))
        startup = statistics.median(bench.run([*shlex.split(options.mpirun), "-n", str(cores), options.gliss_mpi,
                                               "--version"])[0] for _ in range(options.repeats))
        print(f"mpirun of {cores} ranks that do nothing: {startup:.2f} s\n")
        rows, models = [], {}
        for output in options.outputs.split(","):
            for size in map(float, options.samples.split(",")):
                runs = {kind: [] for kind in kinds}
                for _ in range(options.repeats):
                    for kind, (threads, ranks) in kinds.items():
                        runs[kind].append(bench.measure(math.ceil(size), output, threads, ranks))
                        print(f"{output}, {size:.0e}, {kind}: {runs[kind][-1]['whole']:.2f} s, "
                              f"{runs[kind][-1]['used']:.2f} s of processors", flush=True)
                best = {kind: median(of) for kind, of in runs.items()}
                rows.append((output, size, best))
                one = best["1 rank"]["mpi"]
                models[output] = {"part_contacts": one["contacts_computed"] / one["parts"],
                                  "contact": best["1 rank"]["used"] / one["contacts_computed"],
                                  "ask": best[f"{cores} ranks"]["mpi"]["counter_rank_seconds"] / one["parts"],
                                  "write": one["result_seconds"] / one["parts"]}
    print(f"\n| output | HIPs | {' | '.join(f'{kind}, s' for kind in kinds)} | {cores} ranks to 1 | {cores} ranks to {cores} threads "
          "| the same, of processors |")
    print("|---|" + "---|" * (len(kinds) + 4))
    for output, size, best in rows:
        one, threads, many = (best[kind]["whole"] - begin for kind, begin in (
            ("1 rank", startup), (f"{cores} threads", 0), (f"{cores} ranks", startup)))
        used = best[f"{cores} threads"]["used"] / best[f"{cores} ranks"]["used"]
        print(f"| {output} | {size:.0e} | " + " | ".join(f"{best[kind]['whole']:.2f}, {best[kind]['used']:.2f}" for kind in kinds) +
              f" | {one / many:.2f} x | {threads / many:.2f} x | {used:.2f} x |")
    print("\n| output | HIPs | parts | a rank at parts, s | at the counter, s | rank 0 waiting, s | rank 0 at the result, s |\n|---|---|---|---|---|---|---|")
    for output, size, best in rows:
        mpi = best[f"{cores} ranks"]["mpi"]
        print(f"| {output} | {size:.0e} | {mpi['parts']} | {mpi['part_rank_seconds'] / cores:.2f} "
              f"| {mpi['counter_rank_seconds'] / cores:.4f} | {mpi['wait_seconds']:.2f} | {mpi['result_seconds']:.2f} |")
    print("\nThe ratios leave out how long mpirun takes to begin.\n")
    for output, at in models.items():
        said = model(startup, at, options.ranks, options.large * METHODS[output])
        print(f"{output}: {at['contact'] * 1e9:.0f} ns of a processor a contact with its part, {at['ask'] * 1e6:.0f} us a number of the counter, "
              f"{at['write'] * 1e3:.2f} ms a part at the result")
        print(f"{options.ranks:.0f} ranks, {options.large:.0e} HIPs: " +
              ", ".join(f"{what} {value:.3g}" for what, value in said.items()) + " (s)")


if __name__ == "__main__":
    main()
