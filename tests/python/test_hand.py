"""A hand is ticked by one thread at a time."""
import threading

import numpy as np
import pytest


def test_a_hand_pushes_out(cube):
    hand = cube.hand(stiffness=100)
    free = hand.tick([0.5, 0.5, 1.5])
    assert not free.touching and free.distance > 0 and (free.force == 0).all()
    c = hand.tick((0.5, 0.5, 0.9))
    assert c.touching and c.distance < 0 and c.normal[2] > 0.999
    # 100 N/m, depth in cm
    assert abs(c.force[2] + 100 * 0.01 * c.distance) < 1e-12 and c.force[2] > 0
    assert c.point.shape == (3,) and len(c.domain) == 2 and 0 <= c.face < 6 and isinstance(c.flags, int)
    assert not c.slipping and c.cone_share == 0 and "touching=True" in repr(c)
    assert hand.tick(np.array([0.5, 0.5, 2.0], np.float32)).touching is False


def test_a_refused_tick_changes_nothing(cube):
    one, other = cube.hand(), cube.hand()
    for z in np.linspace(1.2, 0.8, 50):
        wanted = one.tick([0.5, 0.5, z])
        with pytest.raises(ValueError):
            other.tick([0.5, float("nan"), z])
        assert other.tick([0.5, 0.5, z]).force.tobytes() == wanted.force.tobytes()


def test_two_threads_on_one_hand_are_refused(knot, path):
    hand = knot.hand()
    long = threading.Thread(target=hand.ticks, args=(np.tile(path, (200, 1)),))
    long.start()
    with pytest.raises(RuntimeError, match="expected one thread at a time"):
        while long.is_alive():
            hand.tick([60, 0, 0])
    long.join()
    assert hand.tick([60, 0, 0]).touching
