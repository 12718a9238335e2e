"""Ctrl-C ends long calls, and leaves parts of a sweep that the next one goes on from."""
import os
import signal
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
    interrupted(lambda: knot.sweep("2mm", 1.2e6, **options), lambda: any(parts.glob("*")))
    assert not output.exists() and list(parts.iterdir())
    sweep = knot.sweep("2mm", 1.2e6, **options)
    assert output.exists() and not parts.exists()
    assert sweep.computed < sweep.statistics[0]["samples"]
