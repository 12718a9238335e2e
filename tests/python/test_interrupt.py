"""Ctrl-C ends long calls, and leaves parts of a sweep that the next one goes on from."""
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest


def interrupted(work, is_time):
    """Holds that work ends soon after Ctrl-C, which comes when it is time."""
    at = []

    def press():
        while not is_time():
            time.sleep(0.01)
        at.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)
    thread = threading.Thread(target=press)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        work()
    thread.join()
    assert time.monotonic() - at[0] < 2


def after(seconds):
    begin = time.monotonic()
    return lambda: time.monotonic() - begin > seconds


def test_questions_end(knot, points):
    interrupted(lambda: knot.nearest(np.tile(points, (3000, 1))), after(0.3))
    assert knot.nearest(points).touching.any()


def test_traces_and_hands_end(knot, path):
    long = np.tile(path, (700, 1))
    interrupted(lambda: knot.trace(long), after(0.7))
    hand = knot.hand()
    interrupted(lambda: hand.ticks(long), after(0.5))
    assert hand.tick([60, 0, 0]).touching


def test_a_sweep_leaves_parts_and_goes_on(knot, tmp_path):
    output, parts = tmp_path / "samples.npy", tmp_path / "samples.parts"
    options = dict(methods="gregory", output=output)
    interrupted(lambda: knot.sweep("2mm", 1.2e6, **options), lambda: any(parts.glob("*.part")))
    assert not output.exists() and list(parts.iterdir())
    sweep = knot.sweep("2mm", 1.2e6, **options)
    assert output.exists() and not parts.exists()
    assert sweep.computed < sweep.statistics[0]["samples"]


def program(text):
    return subprocess.run([sys.executable, "-c", text], env=os.environ, capture_output=True, text=True, timeout=60)


def test_daemon_threads_do_not_abort_the_end():
    done = program("""
import threading, numpy as np, gliss
knot = gliss.Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
points = np.random.default_rng(1).normal(size=(20000, 3))
def work():
    while True:
        knot.nearest(points)
for _ in range(4):
    threading.Thread(target=work, daemon=True).start()
import time; time.sleep(0.3)
""")
    assert done.returncode == 0, done.stderr


def test_small_stacks_are_refused():
    done = program("""
import threading, gliss
threading.stack_size(64 << 10)
def work():
    try:
        gliss.Surface([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    except RuntimeError as error:
        print(error)
thread = threading.Thread(target=work); thread.start(); thread.join()
""")
    assert done.returncode == 0 and "stack is below 384 KiB" in done.stdout, (done.returncode, done.stdout, done.stderr)
