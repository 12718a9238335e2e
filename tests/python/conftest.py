"""What the tests of the Python package share. GLISS_PROGRAM names the program that they compare with."""
import os
import subprocess

import gliss
import numpy as np
import pytest


@pytest.fixture(scope="session")
def program():
    """Runs the program with some words; returns its standard output."""
    if not os.environ.get("GLISS_PROGRAM"):
        pytest.skip("no GLISS_PROGRAM")

    def run(*words):
        done = subprocess.run([os.environ["GLISS_PROGRAM"], *map(str, words)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout
    return run


@pytest.fixture(scope="session")
def knot_file(program, tmp_path_factory):
    path = tmp_path_factory.mktemp("meshes") / "knot.obj"
    program("generate", "knot", "-o", path)
    return path


@pytest.fixture(scope="session")
def knot(knot_file):
    return gliss.load(knot_file, unit="mm")


@pytest.fixture(scope="session")
def points(knot):
    """Some inside, some outside."""
    return np.random.default_rng(1).uniform(*knot.bounds, (2000, 3))


@pytest.fixture(scope="session")
def path(knot):
    """A HIP that wanders beneath the surface, in and out."""
    t = np.linspace(0, 1, 3000)
    return np.column_stack([60 + 3 * np.sin(40 * t), 8 * np.sin(9 * t), 6 * np.sin(7 * t)])


CUBE = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


@pytest.fixture(scope="session")
def cube():
    return gliss.Surface(CUBE, QUADS, unit="cm")
