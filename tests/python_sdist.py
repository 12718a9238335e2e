"""The source distribution has all that the package is built from, and CMake configures it by itself. With
GLISS_LONG_TESTS pip builds and installs the package from it alone, which takes minutes.
Usage: python_sdist.py ROOT BUILD"""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tarfile
import tempfile

from support.skip import skip_unless_required

root, build = map(pathlib.Path, sys.argv[1:])
if importlib.util.find_spec("setuptools") is None:
    skip_unless_required(f"{sys.executable} has no setuptools")

with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "setup.py", "-q", "sdist", "-d", folder], check=True, cwd=root, stderr=subprocess.DEVNULL,
                   env={**os.environ, "GLISS_BUILD_FOLDER": str(build)})
    (packed,) = pathlib.Path(folder).glob("gliss-*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(folder)
    source = pathlib.Path(folder, packed.name.removesuffix(".tar.gz"))
    needed = [file.relative_to(root) for part in ("kernels", "host", "runtime", "python/src", "python/gliss")
              for file in (root / part).rglob("*") if file.is_file() and "__pycache__" not in file.parts]
    absent = [str(file) for file in needed if not (source / file).is_file()]
    assert len(needed) > 300 and not absent, absent
    configured = subprocess.run(
        ["cmake", "-S", source, "-B", source / "build", f"-DPython3_EXECUTABLE={sys.executable}", "-DGLISS_PYTHON=ON",
         *(f"-DGLISS_{name}=OFF" for name in ("TESTS", "BENCH", "REPORT", "MPI"))], capture_output=True, text=True)
    assert configured.returncode == 0, configured.stderr
    if os.environ.get("GLISS_LONG_TESTS"):
        subprocess.run([sys.executable, pathlib.Path(__file__).parent / "python_wheel.py", source], check=True)
    print(f"{len(needed)} files, {packed.stat().st_size >> 10} KiB")
