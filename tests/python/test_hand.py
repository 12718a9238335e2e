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


def test_laws_go_by_the_time_of_a_tick(cube):
    """Viscosity at 500 Hz, 1 and 4 kHz, with ticks left out; a tick is a millisecond unless it says otherwise."""
    for rate in (500, 1000, 4000):
        viscous, slippery = cube.hand(viscosity=4), cube.hand()
        last = -1e-3
        for t in (i / rate for i in range(rate // 5) if i % 58 < 50):
            hip = [0.4 + 2 * t, 0.5, 1.05 - t]  # cm
            resists = viscous.tick(hip, t - last).force - slippery.tick(hip, t - last).force
            last = t
            if t > 0.1:
                assert np.abs(resists + 4 * np.array([0.02, 0, -0.01])).max() < 0.01 * 4 * 0.02, (rate, t)
    one, other = cube.hand(viscosity=4), cube.hand(viscosity=4)
    path = np.linspace([0.2, 0.5, 1.1], [0.4, 0.5, 0.9], 50)
    assert one.ticks(path, "1ms").force.tobytes() == other.ticks(path).force.tobytes()
    for bad in (0, -1e-3, 2, float("nan")):
        with pytest.raises(ValueError, match="dt: "):
            one.tick([0.5, 0.5, 1], bad)


def test_a_trace_goes_by_its_times(cube):
    path = np.linspace([0.2, 0.5, 1.1], [0.4, 0.5, 0.9], 50)
    options = dict(viscosity=4, friction=(0.5, 0.3), friction_settle="5ms")
    usual = cube.trace(path, **options).force
    assert cube.trace(path, time=np.arange(50) * 1e-3, **options).force.tobytes() == usual.tobytes()
    hand = cube.hand(**options)
    timed = cube.trace(path, time=np.arange(50) * 2e-3, **options).force
    assert np.abs(timed - hand.ticks(path, 2e-3).force).max() < 1e-9 < np.abs(timed - usual).max()
    for bad in ([0.0], np.zeros((50, 2)), np.full(50, np.nan)):
        with pytest.raises(ValueError, match="time: "):
            cube.trace(path, time=bad)
    with pytest.raises(ValueError, match="stiffness: -500 is not above 0"):
        cube.hand(stiffness=-500)
