"""Builds the compiled part of the Python package with CMake, in build-wheel/. GLISS_BUILD_FOLDER names a folder that is
configured already, such as build/, for its module to be taken from there."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

root = pathlib.Path(__file__).resolve().parent
given = os.environ.get("GLISS_BUILD_FOLDER")
cmake_folder = pathlib.Path(given).resolve() if given else root / "build-wheel"
leftovers = cmake_folder / "setuptools"  # what it leaves lies there, not among the sources
leftovers.mkdir(parents=True, exist_ok=True)


def cmake(*words):
    subprocess.run(["cmake", *map(str, words)], check=True)


def configure():
    words = ["-S", root, "-B", cmake_folder, "-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"]
    words += [f"-DGLISS_{name}=OFF" for name in ("TESTS", "BENCH", "REPORT", "MPI")] + ["-DGLISS_PYTHON=ON"]
    try:
        import pybind11
        words.append(f"-Dpybind11_DIR={pybind11.get_cmake_dir()}")
    except ImportError:  # that of the system
        pass
    cmake(*words)


class CMakeModule(build_ext):
    def build_extension(self, extension):
        if not given:
            configure()
        cmake("--build", cmake_folder, "--target", "_gliss", "--parallel", len(os.sched_getaffinity(0)))
        path = pathlib.Path(self.get_ext_fullpath(extension.name))
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(cmake_folder / "python" / "gliss" / path.name, path)


setup(version=re.search(r"project\(gliss VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text()).group(1),
      ext_modules=[Extension("gliss._gliss", [])], cmdclass={"build_ext": CMakeModule},
      options={"build": {"build_base": str(leftovers)}, "egg_info": {"egg_base": str(leftovers)}})
