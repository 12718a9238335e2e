"""Checks that GCC compiles every source of the product with -fno-tree-slp-vectorize: without it g++ 12 drops the
rounding of (double)(float)x. usage: narrowing_flags.py COMPILE_COMMANDS SOURCE_DIR"""
import json
import pathlib
import shlex
import subprocess
import sys

from support.skip import skip_unless_required

FLAG = "-fno-tree-slp-vectorize"
SKIP = 77


def words(entry):
    return entry.get("arguments") or shlex.split(entry["command"])


def is_gcc(entry):
    """Asks the first word that says what it is: it may be ccache."""
    for word in words(entry)[:2]:
        answer = subprocess.run([word, "--version"], capture_output=True, text=True, check=False).stdout
        if "Free Software Foundation" in answer:
            return True
    return False


commands, root = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
if not commands.exists():
    skip_unless_required("this generator writes no compile_commands.json")
entries = json.loads(commands.read_text(encoding="utf-8"))
sources = []
for entry in entries:
    source = (pathlib.Path(entry["directory"]) / entry["file"]).resolve()
    if source.is_relative_to(root) and source.relative_to(root).parts[0] in ("host", "runtime", "tools", "bench"):
        sources.append((source, entry))
found = {source for source, _ in sources}
missing = [s for folder in ("host", "runtime", "tools") for s in sorted((root / folder).rglob("*.cpp")) if s not in found]
if missing:
    sys.exit(f"not compiled here: {', '.join(str(s) for s in missing)}")
if not is_gcc(sources[0][1]):
    print("skipped: not GCC")
    sys.exit(SKIP)
bare = []
for source, entry in sources:
    # The last word counts.
    said = [word for word in words(entry) if word in (FLAG, "-ftree-slp-vectorize")]
    if not said or said[-1] != FLAG:
        bare.append(source)
if bare:
    sys.exit(f"without {FLAG}: {', '.join(str(s) for s in bare)}")
print(f"{len(sources)} compilations with {FLAG}")
