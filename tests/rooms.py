"""Checks that no two rooms see each other, and that an include of a room that is not seen does not compile. It asks
the compiler with the very -I of the build. usage: rooms.py COMPILE_COMMANDS SOURCE_DIR"""
import pathlib
import re
import subprocess
import sys

from support.skip import skip_unless_required


def failure(compiler, searches, header):
    """The compiler's words about a file that includes the header; empty if it finds all that it needs."""
    run = subprocess.run([compiler, *searches, "-std=c++20", "-x", "c++", "-E", "-"], cwd="/",
                         input=f'#include "{header}"\n', capture_output=True, text=True, check=False)
    return run.stderr if run.returncode else ""


commands, root = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
if not commands.exists():
    skip_unless_required("this generator writes no compile_commands.json")
sys.dont_write_bytecode = True  # in the sources
sys.path.insert(0, str(root / "tools" / "pictures"))
from seen_rooms import Rooms, library_rooms, program_rooms  # noqa: E402: found there

faults, refused = [], 0
folders = library_rooms(root) + program_rooms(root)
for source in (file for room in folders for file in room.iterdir() if file.is_file()):
    for header in re.findall(r'^\s*#\s*include\s*"([^"]*)"', source.read_text(encoding="utf-8"), re.MULTILINE):
        # A name relative to the file itself would need no -I.
        if not header.startswith("gliss/") and header != "kernels/layout.h" and not (
                header.startswith("kernels/") and "instances_" in source.name) and not (
                header.startswith("tools/") and "tools" in source.relative_to(root).parts):
            faults.append(f"{source}: includes {header}, which is no name of a header in its room")

rooms = Rooms(commands, root, folders)
headers, seen = rooms.headers, rooms.seen
if rooms.not_compiled():
    sys.exit(f"not compiled as rooms: {', '.join(rooms.not_compiled())}")
for room, command in rooms.compiled.items():
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
