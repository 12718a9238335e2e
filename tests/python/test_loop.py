"""The loop runs in a thread of its own, and Python reads its ticks."""
import os
import signal
import subprocess
import sys
import time

import gliss
import numpy as np
import pytest

SCENE = """[[object]]
mesh = "knot.obj"
unit = "mm"
stiffness = "0.5N/mm"

[sim]
waypoints = [["70mm", 0, 0], ["60mm", 0, 0], ["60mm", "20mm", 0]]
"""


@pytest.fixture(scope="module")
def scene(knot_file):
    path = knot_file.with_name("scene.toml")
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def endless_scene(scene):
    """A hand that goes to and fro in the open."""
    path = scene.with_name("endless.toml")
    path.write_text(SCENE[:SCENE.index("waypoints")] + 'waypoints = [["75mm", 0, 0], ["80mm", 0, 0]]\nrounds = 1000\n')
    return path


def test_python_reads_every_tick(scene, program, tmp_path):
    program("run", scene, "--device", "sim", "--no-wait", "--record", tmp_path / "run.csv", "--quiet")
    recorded = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    with gliss.Loop(scene, "sim", wait=False) as loop:
        assert loop.wait(30)
        ticks = loop.read()
        assert not loop.running and loop.lost == 0 and loop.end == "the device has ended" and loop.device == "sim"
        assert len(loop.read()) == 0
    assert loop.closed
    assert (ticks["number"] == np.arange(len(ticks))).all() and len(ticks) == len(recorded)
    forces = np.column_stack([recorded[name] for name in ("fx", "fy", "fz")])
    assert ticks["rendered"].tobytes() == forces.tobytes()
    assert ticks["touching"].any() and (ticks["distance"][ticks["touching"]] < 0).all()
    assert set(ticks["guard"]) <= {b"start", b"run", b"hold", b"ramp", b"safe"}
    assert ticks["position"].shape == (len(ticks), 3) and (ticks["orientation"] == [1, 0, 0, 0]).all()


def test_a_loop_keeps_its_pace_while_python_works(scene):
    with gliss.Loop(scene, seconds=0.3, realtime=False) as loop:
        assert loop.running and loop.end is None
        assert not loop.wait(0.05)
        assert loop.wait()
        ticks = loop.read()
    assert len(ticks) + ticks["missed"].sum() >= 250  # of 300, if nothing else is there
    assert loop.refusals == []


def test_two_arms_have_what_one_has(scene):
    with gliss.Loop(scene, cpu=0) as one, gliss.Loop(scene, cpu=0) as other:
        while not (len(one.read()) and len(other.read())):
            time.sleep(0.01)
        assert one.refusals == other.refusals
        assert not any("processor" in line for line in one.refusals)


def await_guard(loop, state):
    """Reads ticks until the last one has this state of the guard."""
    begun = time.monotonic()
    while not any(loop.read()["guard"][-1:] == state):
        assert time.monotonic() - begun < 20, f"the guard is never {state}"
        time.sleep(0.01)


def test_engage_gives_the_force_back_after_silence(endless_scene):
    words = [os.environ["GLISS_PROGRAM"], "serve", endless_scene, "--port", "0"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as server:
        try:
            port = server.stderr.readline().split("udp:")[1].strip()
            with gliss.Loop(endless_scene, f"udp:{port}") as loop:
                await_guard(loop, b"run")
                server.send_signal(signal.SIGSTOP)
                await_guard(loop, b"safe")
                server.send_signal(signal.SIGCONT)
                time.sleep(0.1)
                assert loop.read()["guard"][-1] == b"safe"  # until it is asked
                loop.engage()
                await_guard(loop, b"run")
        finally:
            server.kill()
    with pytest.raises(ValueError, match="closed"):
        loop.engage()


@pytest.mark.skipif(sys.platform == "win32", reason="no fork")
def test_a_child_of_fork_ends_while_its_parent_has_a_loop(scene):
    with gliss.Loop(scene, realtime=False) as loop:
        child = os.fork()
        if child == 0:
            closed = loop.closed and not loop.running
            loop.close()
            os._exit(0 if closed else 1)
        begun = time.monotonic()
        while os.waitpid(child, os.WNOHANG) == (0, 0):
            assert time.monotonic() - begun < 20, "the child hangs"
            time.sleep(0.01)
        assert loop.running and not loop.closed


def test_a_closed_loop_is_refused(scene):
    loop = gliss.Loop(scene, realtime=False)
    loop.close()
    loop.close()
    assert not loop.running
    for call in (loop.read, loop.wait):
        with pytest.raises(ValueError, match="the loop is closed; expected one that is open"):
            call()


@pytest.mark.skipif(not os.path.isdir("/proc/self/task"), reason="no list of threads")
def test_a_forgotten_loop_ends(endless_scene):
    def threads():
        return len(os.listdir("/proc/self/task"))

    gliss.Loop(endless_scene, realtime=False).close()  # threads that build objects stay
    before = threads()
    loop = gliss.Loop(endless_scene, realtime=False)
    assert threads() > before
    del loop
    assert threads() <= before


def test_a_loop_ends_with_python(scene):
    script = f"import gliss\nloop = gliss.Loop({str(scene)!r}, realtime=False)\nloop.me = loop\nprint(loop.running)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=20)
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\n", "")


def test_slips_of_loops_are_told(scene, tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text("[[object]]\nmash = 3\n")
    with pytest.raises(gliss.SceneError, match="bad.toml"):
        gliss.Loop(bad)
    with pytest.raises(ValueError, match="device: 'hand' is not one of sim"):
        gliss.Loop(scene, "hand")
    with pytest.raises(gliss.DeviceError, match="no haptic device answered"):
        gliss.Loop(scene, "udp:10937")
    with pytest.raises(ValueError, match="seconds: -1"):
        gliss.Loop(scene, seconds=-1)
    bad.write_text(SCENE.replace("knot.obj", "none.obj"))
    with pytest.raises(gliss.SceneError, match="none.obj"):
        gliss.Loop(bad)
