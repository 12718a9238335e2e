"""Checks that no two rooms see each other, and that an include of a room that is not seen does not compile. It asks
the compiler with the very -I of the build. usage: rooms.py COMPILE_COMMANDS SOURCE_DIR"""
import json
import pathlib
import re
import shlex
import subprocess
import sys

from support.skip import skip_unless_required


def searches_of(entry):
    """The compiler of a command, and where that looks for headers."""
    words = entry.get("arguments") or shlex.split(entry["command"])
    compiler = words[1] if words[0].endswith("ccache") else words[0]
    searches = [word for word in words if word.startswith("-I")]
    for option, folder in zip(words, words[1:]):
        if option == "-isystem":
            searches += [option, folder]
    return compiler, searches


def failure(compiler, searches, header):
    """The compiler's words about a file that includes the header; empty if it finds all that it needs."""
    run = subprocess.run([compiler, *searches, "-std=c++20", "-x", "c++", "-E", "-"], cwd="/",
                         input=f'#include "{header}"\n', capture_output=True, text=True, check=False)
    return run.stderr if run.returncode else ""


commands, root = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
if not commands.exists():
    skip_unless_required("this generator writes no compile_commands.json")
faults, refused = [], 0
rooms = [folder for top in ("host", "runtime", "tools/cli") for folder in (root / top).iterdir() if folder.is_dir()]
rooms.append(root / "tools" / "report")
for source in (file for room in rooms for file in room.iterdir() if file.is_file()):
    for header in re.findall(r'^\s*#\s*include\s*"([^"]*)"', source.read_text(encoding="utf-8"), re.MULTILINE):
        # A name relative to the file itself would need no -I.
        if not header.startswith("gliss/") and header != "kernels/layout.h" and not (
                header.startswith("kernels/") and "instances_" in source.name) and not (
                header.startswith("tools/") and "tools" in source.relative_to(root).parts):
            faults.append(f"{source}: includes {header}, which is no name of a header in its room")

# Those of the tools go by their paths.
headers = {room.name: f"{room.relative_to(root) if 'tools' in room.relative_to(root).parts else f'gliss/{room.name}'}/"
                      f"{sorted(room.glob('*.h'))[0].name}" for room in rooms}
compiled = {}
for entry in json.loads(commands.read_text(encoding="utf-8")):
    source = (pathlib.Path(entry["directory"]) / entry["file"]).resolve()
    if source.is_relative_to(root) and source.name != "instances_isa.cpp":  # that one sees the kernels, too
        if source.parent in rooms:
            compiled[source.parent.name] = searches_of(entry)
if compiled.keys() != headers.keys():
    sys.exit(f"not compiled as rooms: {', '.join(compiled.keys() ^ headers.keys())}")

seen = {room: {other for other, header in headers.items()
               if any((pathlib.Path(word[2:]) / header).exists() for word in compiled[room][1] if word.startswith("-I"))}
        for room in headers}
for room, command in compiled.items():
    said = failure(*command, headers[room])
    if said:
        faults.append(f"{room}: its own header is not found: {said}")
    faults += [f"{room} and {other} see each other" for other in seen[room] if other > room and room in seen[other]]
    unseen = [header for other, header in headers.items() if other not in seen[room]]
    for header in unseen + ["host/base/vector.h", "kernels/real.h", "tools/cli/program.h"]:
        if "No such file or directory" not in failure(*command, header):
            faults.append(f"{room}: an include of {header} compiles")
        refused += 1
if faults:
    sys.exit("\n".join(faults))
print(f"{len(headers)} rooms; {refused} includes of what they do not see are refused")
