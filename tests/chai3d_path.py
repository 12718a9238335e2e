"""With a CHAI3D (GLISS_CHAI3D_DIR): its tool feels along a path, in each tick, what gliss trace does.
usage: chai3d_path.py CHAI3D_PATH GLISS [MESH PATH], of a mesh and a table of HIPs in mm; else of ones that Gliss makes"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

program, gliss, *given = (pathlib.Path(word).resolve() for word in sys.argv[1:])
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    mesh, path = given or (folder / "knot.obj", None)
    if path is None:
        subprocess.run([gliss, "generate", "knot", "-o", mesh], check=True, capture_output=True)
    subprocess.run([gliss, "trace", mesh, "--unit", "mm", *(["--path", path] if path else ["--depth", "1mm"]), "--method",
                    "gregory", "--stiffness", "0.5N/mm", "-o", "trace.csv"], cwd=folder, check=True, capture_output=True)
    with (folder / "trace.csv").open() as table:
        ticks = list(csv.DictReader(table))
    hips = "".join(f"{tick['x']} {tick['y']} {tick['z']}\n" for tick in ticks)
    run = subprocess.run([program, mesh, "mm"], input=hips, capture_output=True, text=True, check=True)
    forces = list(csv.DictReader(run.stdout.splitlines()))
    off = [math.dist(*([float(row[axis]) for axis in ("fx", "fy", "fz")] for row in rows)) for rows in zip(ticks, forces)]
    felt = sum(float(row["fx"]) != 0 for row in forces)
    print(f"{len(ticks)} ticks, {felt} in contact: forces within {max(off):.1e} N of those of gliss trace")
    if len(forces) != len(ticks) or felt < len(ticks) / 2 or not max(off) < 1e-9:
        sys.exit(1)
