#!/usr/bin/env python3
"""What the way from NumPy to NumPy costs: a million HIPs asked of the Python package, over the same asked of the engine.

Both run in one process, in turns: the engine with arrays that are ready, as a C++ program would have them, and
Surface.nearest with all that it does besides: checks, new arrays, the GIL. Goal: a ratio of at most 1.1.
Needs a build with GLISS_PYTHON. Usage: PYTHONPATH=build/python bench/python.py [--hips 1000000] [--rounds 5]
"""
import argparse
import statistics
import time

import gliss
import numpy as np
from gliss import _gliss


def torus(around, across):
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    ring = 40 + 15 * np.cos(v)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    right, up = (i + 1) % around, (j + 1) % across
    quads = np.stack([i * across + j, right * across + j, right * across + up, i * across + up], axis=-1)
    return np.stack([ring * np.cos(u), ring * np.sin(u), 15 * np.sin(v)], axis=-1).reshape(-1, 3), quads.reshape(-1, 4)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hips", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    surface = gliss.Surface(*torus(60, 24), unit="mm")
    rng = np.random.default_rng(1)
    on = surface.evaluate(rng.integers(surface.face_count, size=options.hips), rng.uniform(-0.5, 0.5, (options.hips, 2)))
    hips = on.point - rng.uniform(-2, 2, (options.hips, 1)) * on.normal  # mm

    def seconds(work):
        start = time.perf_counter()
        work()
        return time.perf_counter() - start

    ratios, best = [], float("inf")
    for _ in range(options.rounds):
        engine = _gliss.engine_seconds(surface._open, hips)
        whole = seconds(lambda: surface.nearest(hips))
        ratios.append(whole / engine)
        best = min(best, whole)
    print(f"nearest: {options.hips / best / 1e6:.3f} M HIPs/s; over the engine's own time: median "
          f"{statistics.median(ratios):.3f}, {min(ratios):.3f} to {max(ratios):.3f}")
    hand, hip = surface.hand(), hips[0]
    count = 200_000
    call = seconds(lambda: [hand.tick(hip) for _ in range(count)]) / count
    loop = seconds(lambda: hand.ticks(np.broadcast_to(hip, (count, 3)))) / count
    print(f"hand: {1e6 * call:.2f} us a tick, of which the engine {1e6 * loop:.2f}")


if __name__ == "__main__":
    main()
