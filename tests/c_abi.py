"""The ABI of libgliss.so.0 is the one that was stored: names, arguments and structs of its header, as abidw finds them in
a library of those declarations with empty bodies. That the real library exports these and no more, c_api.py holds.

usage: c_abi.py HEADER DUMP            compares
       c_abi.py --store HEADER DUMP    stores a new dump"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from support.skip import skip_unless_required

store = sys.argv[1] == "--store"
header, stored = map(pathlib.Path, sys.argv[1 + store:])
if not shutil.which("abidw") or not shutil.which("abidiff"):
    skip_unless_required("no abidw and abidiff: install abigail-tools")


def dump(text, folder, name):
    """The ABI that a header of this text declares."""
    bodies, count = re.subn(r"(GLISS_API [^;]*\));", r"\1 { __builtin_trap(); }", text)
    if count < 10:
        sys.exit(f"{header} declares {count} functions")
    (folder / f"{name}.h").write_text(text)
    (folder / f"{name}.c").write_text(bodies)
    subprocess.run(["cc", "-std=c99", "-g", "-O0", "-fPIC", "-shared", "-Wl,-soname,libgliss.so.0", f"{name}.c", "-o",
                    f"{name}.so"], cwd=folder, check=True)
    subprocess.run(["abidw", "--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--type-id-style", "hash",
                    f"{name}.so", "--out-file", f"{name}.abi"], cwd=folder, check=True)
    return folder / f"{name}.abi"


def difference(before, after, *options):
    """What abidiff says; empty: nothing."""
    run = subprocess.run(["abidiff", *options, before, after], capture_output=True, text=True, check=False)
    return run.stdout + run.stderr if run.returncode else ""


def incompatible(before, after):
    return difference(before, after, "--no-added-syms")


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    text = header.read_text()
    now = dump(text, folder, "now")
    if store:
        shutil.copy(now, stored)
        sys.exit()
    told = difference(stored, now)
    if told:
        kind = ("incompatible with programs that are built: raise the upper half of GLISS_ABI and the SOVERSION, or undo it"
                if incompatible(stored, now) else "compatible: raise the lower half of GLISS_ABI")
        sys.exit(f"{told}\nThe ABI has changed. It is {kind}. Then store it and commit the dump:\n"
                 f"  python3 tests/c_abi.py --store {header} {stored}")
    # It would be seen.
    for before, after in (("  double damping; ", "  float damping; "), ("size_t faces,", "uint32_t faces,"),
                          ("GLISS_API double gliss_surface_unit(const gliss_surface* surface);", "")):
        if text.count(before) != 1:
            sys.exit(f"{header} has '{before}' {text.count(before)} times")
        if not incompatible(now, dump(text.replace(before, after), folder, "changed")):
            sys.exit(f"abidiff does not see '{after}' for '{before}'")
