"""Holds that the pages of the documentation are right where a program can tell: links, anchors, headers and functions
that they name are there, whole programs in C++ and C that they show compile, and pictures are what the sources say.

Usage: pages.py ROOT ROOMS EIGEN COMPILER COMPILE_COMMANDS: ROOMS holds a folder of headers for each room, EIGEN those
of Eigen.
"""
import functools
import pathlib
import re
import subprocess
import sys

root, rooms, eigen = map(pathlib.Path, sys.argv[1:4])
compiler, commands = sys.argv[4], pathlib.Path(sys.argv[5])
sys.dont_write_bytecode = True  # in the sources
sys.path.insert(0, str(root / "tools" / "pictures"))
from draw import pictures  # noqa: E402: found there

pages = sorted(path for folder in (".", "docs", "bench", "tests") for path in (root / folder).glob("*.md"))
folders = [folder for folder in rooms.iterdir() if (folder / "gliss").is_dir()]


def slug(heading):
    """The anchor that a heading gets."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    return {slug(heading) for heading in re.findall(r"^#+ (.*)$", text, flags=re.M)}


def wrong_links(page):
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        if target.startswith(("http:", "https:", "mailto:")):
            continue
        path, _, anchor = target.partition("#")
        there = page.parent / path if path else page
        if not there.exists():
            yield f"no file '{path}'"
        elif anchor and anchor not in anchors(there):
            yield f"no heading for '{target}'"


def wrong_headers(page):
    for header in re.findall(r"[`<](gliss/[\w/]+\.h)[`>]", page.read_text()):
        if not any((folder / header).exists() for folder in folders):
            yield f"no header '{header}'"


@functools.cache
def words_of_sources():
    return {word for folder in ("kernels", "host", "runtime", "tools", "tests", "python")
            for ending in ("h", "cpp", "inc", "cl", "txt") for path in (root / folder).rglob(f"*.{ending}")
            for word in re.findall(r"\w+", path.read_text())}


def wrong_names(page):
    """Rows of tables that say that a file has names which it does not have."""
    for file, names in re.findall(r"\| `([\w/]+\.\w+)` \| (`[^|]*`) \|$", page.read_text(), flags=re.M):
        text = (root / file).read_text() if (root / file).exists() else ""
        for name in re.findall(r"`(\w+)`", names):
            if not re.search(rf"\b{name}\b", text):
                yield f"no '{name}' in '{file}'"
    if page.name == "architecture.md":  # its names are somewhere
        for name in re.findall(r"`(\w+)(?:::\w+)?`", page.read_text()):
            if name not in words_of_sources():
                yield f"no '{name}' in the sources"


def wrong_programs(page):
    for fence, program in re.findall(r"^```(cpp|c)\n(.*?)^```", page.read_text(), flags=re.M | re.S):
        if "int main" not in program:
            continue
        language = ["-std=c++20", "-x", "c++"] if fence == "cpp" else ["-std=c99", "-pedantic-errors", "-x", "c"]
        words = [compiler, *language, "-fsyntax-only", "-Wall", "-Werror", "-", f"-isystem{eigen}"]
        told = subprocess.run(words + [f"-I{folder}" for folder in folders], input=program, text=True,
                              capture_output=True)
        if told.returncode != 0:
            yield "a program does not compile:\n" + told.stderr


def wrong_pictures():
    """Those of docs/pictures that tools/pictures/draw.py would draw in another way, or not at all."""
    if not commands.exists():  # this generator writes none
        return
    drawn = {name: text.encode() for name, text in pictures(commands, root.resolve()).items()}
    kept = {path.name: path.read_bytes() for path in (root / "docs" / "pictures").iterdir()}
    for name in sorted(drawn.keys() | kept.keys()):
        if drawn.get(name) != kept.get(name):
            yield f"docs/pictures/{name}: not as drawn; tools/pictures/draw.py draws all"


faults = [f"{page.relative_to(root)}: {fault}" for page in pages
          for find in (wrong_links, wrong_headers, wrong_names, wrong_programs) for fault in find(page)]
faults += wrong_pictures()
print("\n".join(faults) or f"{len(pages)} pages")
sys.exit(1 if faults or len(pages) < 5 else 0)
