"""pip installs the Python package into an environment of its own, with the module of an existing build or, without BUILD,
with one that it builds; nothing else is in it, and it works. Usage: python_wheel.py ROOT [BUILD]"""
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from support.skip import skip_unless_required

root = pathlib.Path(sys.argv[1])
module_of = {"GLISS_BUILD_FOLDER": sys.argv[2]} if len(sys.argv) > 2 else {}
absent = [name for name in ("pip", "ensurepip", "setuptools", "wheel") if importlib.util.find_spec(name) is None]
if absent:
    skip_unless_required(f"{sys.executable} has no {', '.join(absent)}")
USE = """
import gliss, numpy
corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
cube = gliss.Surface(corners, quads, unit="mm")
assert cube.nearest([[0.5, 0.5, 0.9]]).distance[0] < 0
print(gliss.__version__, gliss.__file__)
"""


def run(*words, **options):
    return subprocess.run(words, check=True, **options)


with tempfile.TemporaryDirectory() as folder:
    run(sys.executable, "-m", "venv", "--system-site-packages", folder)
    python = pathlib.Path(folder, "bin", "python")
    run(python, "-m", "pip", "install", "--no-build-isolation", "--no-deps", "--no-index", "--quiet",
        "--disable-pip-version-check", root, env={**os.environ, **module_of})
    said = run(python, "-c", USE, cwd=folder, capture_output=True, text=True).stdout.split()
    listed = run(python, "-m", "pip", "show", "--files", "gliss", capture_output=True, text=True).stdout
version = re.search(r"VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8").split("project(gliss")[1])
assert said[0] == version[1] and said[1].startswith(folder), said
files = {line.strip() for line in listed.split("Files:")[1].splitlines() if "__pycache__" not in line} - {""}
package = {file for file in files if ".dist-info/" not in file}
module = next(file for file in package if file.endswith(".so"))
assert package == {"gliss/__init__.py", "gliss/__init__.pyi", "gliss/py.typed", module}, package
assert module.startswith("gliss/_gliss.") and f"gliss-{said[0]}.dist-info/LICENSE" in files, files
assert "Requires: numpy" in listed, listed
print(f"{len(files)} files")
