"""Runs the tests of the Python package, tests/python, with pytest. Usage: python_package.py PROGRAM FOLDER, which holds
the package `gliss`."""
import importlib.util
import os
import pathlib
import subprocess
import sys

from support.skip import skip_unless_required

program, folder = sys.argv[1:]
absent = [name for name in ("pytest", "mypy", "h5py") if importlib.util.find_spec(name) is None]
if absent:
    skip_unless_required(f"{sys.executable} has no {', '.join(absent)}")
tests = pathlib.Path(__file__).resolve().parent / "python"
sys.exit(subprocess.run(
    [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=3", tests],
    env={**os.environ, "PYTHONPATH": folder, "GLISS_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}).returncode)
