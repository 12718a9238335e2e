"""What the stubs promise is there, and has the types that a user writes."""
import os
import pathlib
import subprocess
import sys

import gliss

USER = '''
import numpy as np
import gliss
surface = gliss.load("knot.obj", unit="mm", level="table:8")
c: gliss.Contacts = surface.nearest(np.zeros((1, 3)), "flat")
depth: float = float(c.distance.min())
force: float = surface.hand(friction=(0.5, 0.3)).tick([0, 0, 0]).force[2]
with gliss.Loop("scene.toml") as loop:
    n: int = len(loop.read())
surface.nearest(np.zeros((1, 3)), "bumpy")
'''


def test_stubs_are_those_of_the_module(tmp_path):
    env = {**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]}
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "gliss"], cwd=tmp_path, env=env, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_user_is_checked_by_types(tmp_path):
    (tmp_path / "user.py").write_text(USER)
    done = subprocess.run([sys.executable, "-m", "mypy", "user.py"], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MYPYPATH": os.environ["PYTHONPATH"]})
    wrong = USER.splitlines().index("surface.nearest(np.zeros((1, 3)), \"bumpy\")") + 1
    assert f"user.py:{wrong}: error" in done.stdout and "Found 1 error" in done.stdout, done.stdout


def test_all_is_documented():
    assert (pathlib.Path(gliss.__file__).parent / "py.typed").exists()
    for name in gliss.__all__:
        if name != "__version__":
            thing = getattr(gliss, name)
            assert thing.__doc__, name
            for member, value in vars(thing).items():
                assert member.startswith("_") or not (callable(value) or isinstance(value, property)) or \
                    value.__doc__, f"{name}.{member}"
