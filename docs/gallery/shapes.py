"""Meshes of the gallery, and its pictures."""
import os
import sys

import numpy as np


def torus(around, across, major=40.0, minor=15.0):
    """Vertices (mm) and quads."""
    u = np.arange(around) * 2 * np.pi / around
    v = np.arange(across) * 2 * np.pi / across
    u, v = (a.ravel() for a in np.meshgrid(u, v, indexing="ij"))
    ring = major + minor * np.cos(v)
    vertices = np.column_stack([ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)])
    i, j = (a.ravel() for a in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    right, up = (i + 1) % around, (j + 1) % across
    return vertices, np.column_stack([i * across + j, right * across + j, right * across + up, i * across + up])


def picture(draw):
    """Calls draw(pyplot) and saves what it drew in the file that the command line names; without a file, or without
    matplotlib, it draws nothing."""
    if len(sys.argv) < 2:
        return
    try:
        os.environ.setdefault("MPLBACKEND", "Agg")
        from matplotlib import pyplot
    except ImportError:
        print("no matplotlib: no picture")
        return
    draw(pyplot)
    pyplot.savefig(sys.argv[1], dpi=120, bbox_inches="tight")
