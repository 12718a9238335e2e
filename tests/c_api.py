"""libgliss.so.0 from outside: it exports what its header declares and no more; the header is C99 and C++; the example
compiles and runs; Python's ctypes touches a mesh, on the page of C too.
usage: c_api.py LIBRARY INCLUDES EXAMPLE GLISS PAGE"""
import ctypes
import os
import pathlib
import re
import subprocess
import sys
import tempfile

library, includes, example, gliss, page = (pathlib.Path(word).resolve() for word in sys.argv[1:])
header = includes / "gliss" / "gliss_c.h"


def run(*words):
    result = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if result.returncode:
        sys.exit(f"{words}: {result.returncode}\n{result.stdout}{result.stderr}")
    return result.stdout


declared = set(re.findall(r"\b(gliss_\w+)\(", re.sub(r"/\*.*?\*/|static inline [^}]*}", "", header.read_text(),
                                                     flags=re.DOTALL)))
exported = {line.split()[-1].split("@")[0] for line in run("nm", "-D", "--defined-only", library).splitlines()}
exported.discard("GLISS_0")
if declared != exported:
    sys.exit(f"the header alone: {declared - exported}; the library alone: {exported - declared}")
if "libgliss.so.0" not in run("readelf", "-d", library):
    sys.exit("its SONAME is not libgliss.so.0")

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    strict = ("-pedantic", "-Wall", "-Wextra", "-Werror", f"-I{includes}")
    (folder / "only.c").write_text('#include <gliss/gliss_c.h>\nint main(void) { return 0; }\n')
    run("cc", "-std=c99", *strict, folder / "only.c", "-o", folder / "only")
    run("c++", "-std=c++11", "-x", "c++", *strict, "-fsyntax-only", folder / "only.c")
    run("cc", "-std=c99", *strict, example, library, f"-Wl,-rpath,{library.parent}", "-o", folder / "hand")
    run(gliss, "generate", "goldberg", "-o", folder / "ball.obj")
    lines = run(folder / "hand", folder / "ball.obj", "0.001").splitlines()
    rows = [list(map(float, line.split(","))) for line in lines[1:]]
    if lines[0] != "z_m,wanted_N,sent_N,distance_m" or len(rows) != 12:
        sys.exit(f"the example prints {lines}")
    for z, wanted, _, distance in rows:
        if abs(wanted - 500 * max(0, -distance)) > 1e-6 * 500 * 1e-3 + 0.02 * wanted:
            sys.exit(f"at {z} m the force is {wanted} N, {-distance} m deep")
    if not rows[-1][1] > 0.5:
        sys.exit(f"the example does not touch: {rows[-1]}")

    # Python's ctypes, without a wrapper.
    lib = ctypes.CDLL(str(library))
    lib.gliss_last_error.restype = ctypes.c_char_p
    lib.gliss_surface_unit.restype = ctypes.c_double
    surface = ctypes.c_void_p()
    if lib.gliss_surface_load(b"none.obj", None, ctypes.byref(surface)) != 2 or \
            b"none.obj" not in lib.gliss_last_error():
        sys.exit("a missing file is not a bad input")
    if lib.gliss_surface_load(bytes(folder / "ball.obj"), None, ctypes.byref(surface)):
        sys.exit(lib.gliss_last_error())
    contact = (ctypes.c_uint64 * 16)()
    point = (ctypes.c_double * 3)(0, 0, 8)
    if lib.gliss_surface_nearest(surface, 0, point, ctypes.c_size_t(0), ctypes.c_size_t(8), ctypes.c_size_t(1), contact):
        sys.exit(lib.gliss_last_error())
    if ctypes.cast(contact, ctypes.POINTER(ctypes.c_uint32))[0] != 1:
        sys.exit("a point in the ball does not touch")
    lib.gliss_surface_release(surface)

    # The page shows a program for ctypes, which runs.
    shown = re.search(r"^```python\n(.*?)^```", page.read_text(), flags=re.M | re.S)[1]
    told = subprocess.run([sys.executable, "-c", shown], cwd=folder, capture_output=True, text=True, check=False,
                          env={**os.environ, "LD_LIBRARY_PATH": str(library.parent)})
    if told.returncode or told.stdout.count(", ") != 4:
        sys.exit(f"{page}: {told.stdout}{told.stderr}")
