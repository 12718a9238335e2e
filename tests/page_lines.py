"""Does what the pages of the library and of C show, with their own lines: installs a build tree, and builds and runs
their programs, in C++ by CMake, and in C by CMake and by pkg-config. A page's DIR is FOLDER/prefix, which stays.

Usage: page_lines.py BUILD DOCS FOLDER
"""
import math
import pathlib
import re
import shutil
import subprocess
import sys

build, docs, folder = (pathlib.Path(word).resolve() for word in sys.argv[1:])


def block(page, fence, what):
    """The block of a page in that language which has `what` in it."""
    blocks = re.findall(rf"^```{fence}\n(.*?)^```", (docs / page).read_text(encoding="utf-8"), flags=re.M | re.S)
    found = [text for text in blocks if what in text]
    if len(found) != 1:
        sys.exit(f"{page}: '{what}' is in {len(found)} blocks of {fence}, not in 1")
    return found[0]


def run(lines, where):
    """What these lines of a page print in this folder."""
    lines = re.sub(r"\bDIR\b", str(folder / "prefix"), lines).replace("build-quickstart", str(build))
    told = subprocess.run(["bash", "-euc", lines], cwd=where, capture_output=True, text=True, check=False)
    if told.returncode:
        sys.exit(f"{lines}ended with {told.returncode}:\n{told.stdout}{told.stderr}")
    return told.stdout


def project(name, files):
    """A new folder with these files."""
    where = folder / name
    where.mkdir(parents=True)
    for file, text in files.items():
        (where / file).write_text(text, encoding="utf-8")
    return where


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
run(block("library.md", "sh", "--install"), folder)
build_lines = block("library.md", "sh", "-DCMAKE_PREFIX_PATH=DIR")

app = project("app", {"CMakeLists.txt": block("library.md", "cmake", "add_executable"),
                      "app.cpp": block("library.md", "cpp", "int main")})
run(build_lines, app)
touching, *force, _ = run(block("library.md", "sh", "build/app"), app).splitlines()[-1].split()

first = project("first", {"CMakeLists.txt": block("c.md", "cmake", "add_executable"),
                          "first.c": block("c.md", "c", "int main")})
shutil.copy(app / "knot.obj", first)
run(build_lines, first)
by_cmake = run("build/first", first)
millimetres = float(by_cmake.split()[0])
if touching != "1" or not math.isclose(math.hypot(*map(float, force)), -millimetres / 1e3 * 500, rel_tol=1e-4):
    sys.exit(f"C++ has a force of {force} N at 500 N/m, C a distance of {millimetres} mm")

if shutil.which("pkg-config"):
    by_pkg_config = run(block("c.md", "sh", "PKG_CONFIG_PATH=") + block("c.md", "sh", "pkg-config --cflags") + "./first",
                        first)
    if by_pkg_config != by_cmake:
        sys.exit(f"C prints {by_cmake} by CMake and {by_pkg_config} by pkg-config")
print(f"as the pages say: {by_cmake}", end="")
