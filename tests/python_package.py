"""Runs the tests of the Python package, tests/python, with pytest. Usage: python_package.py PROGRAM FOLDER [COMPILER].
FOLDER holds the package `gliss`. Without a PROGRAM, "", tests that compare with it are skipped. COMPILER is that of a
module that was built with sanitizers."""
import importlib.util
import os
import pathlib
import subprocess
import sys

from support.skip import skip_unless_required

program, folder, *compiler = sys.argv[1:]
absent = [name for name in ("pytest", "mypy", "h5py") if importlib.util.find_spec(name) is None]
if absent:
    skip_unless_required(f"{sys.executable} has no {', '.join(absent)}")
tests = pathlib.Path(__file__).resolve().parent / "python"
# Libraries of sanitizers come before all others.
preload = [subprocess.run([*compiler, f"-print-file-name={name}"], capture_output=True, text=True).stdout.strip()
           for name in ("libasan.so", "libubsan.so")] if compiler else []
sys.exit(subprocess.run(
    [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--durations=3", tests],
    env={**os.environ, "PYTHONPATH": folder, "GLISS_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1",
         **({"LD_PRELOAD": ":".join(preload)} if preload else {})}).returncode)
