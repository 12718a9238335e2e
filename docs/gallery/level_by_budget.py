"""Chooses the level of patches that is the quickest within a budget of error and memory."""
import time

import gliss
import numpy as np

from shapes import picture, torus

BUDGET = {"error": 0.01, "bytes": 4e6}  # of the full force; of the patches

vertices, quads = torus(24, 12)
exact = gliss.Surface(vertices, quads, unit="mm", construction="paper")
on = exact.evaluate(np.repeat(np.arange(exact.faces), 8), np.tile(np.random.default_rng(1).uniform(
    -0.5, 0.5, (8, 2)), (exact.faces, 1)))
hips = on.point - 1.0 * on.normal  # 1 mm deep
wanted = exact.force(hips)
full = np.linalg.norm(wanted, axis=1).max()

rows = []
for level in ("exact", "ribbon", "bezier", "table", "table:8"):
    surface = gliss.Surface(vertices, quads, unit="mm", construction="paper", level=level)
    start = time.perf_counter()
    force = surface.force(hips)
    seconds = time.perf_counter() - start
    error = np.linalg.norm(force - wanted, axis=1).max() / full
    rows.append((level, error, surface.nbytes, seconds / len(hips)))
    print(f"{level:8} error {100 * error:7.4f} %, {surface.nbytes / 1e6:5.2f} MB, {1e6 * rows[-1][3]:5.2f} us a HIP")
fit = [row for row in rows if row[1] <= BUDGET["error"] and row[2] <= BUDGET["bytes"]]
print(f"within the budget the quickest is {min(fit, key=lambda row: row[3])[0]}" if fit else "none is within the budget")


def draw(plt):
    plt.figure(figsize=(6, 4))
    for level, error, nbytes, seconds in rows:
        plt.scatter(nbytes / 1e6, max(error, 1e-7))
        plt.annotate(level, (nbytes / 1e6, max(error, 1e-7)), xytext=(5, 5), textcoords="offset points")
    plt.axhline(BUDGET["error"], color="gray", linestyle=":")
    plt.axvline(BUDGET["bytes"] / 1e6, color="gray", linestyle=":")
    plt.yscale("log")
    plt.xlabel("memory, MB")
    plt.ylabel("largest error of the force")


picture(draw)
