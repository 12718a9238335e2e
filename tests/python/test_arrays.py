"""NumPy arrays in and out."""
import gc
import threading

import gliss
import numpy as np
import pytest

from conftest import CUBE, QUADS


def bytes_of(results):
    return {name: array.tobytes() for name, array in dict(results).items()}


def test_any_form_of_faces_makes_the_same_surface(cube, tmp_path):
    quads = np.array(QUADS)
    offsets = np.arange(0, 25, 4)
    padded = np.insert(quads, 0, 4, axis=1).ravel()
    probe = np.random.default_rng(2).uniform(-0.5, 1.5, (200, 3))
    wanted = bytes_of(cube.nearest(probe))
    for faces in (quads, quads.astype(np.uint8), (offsets, quads.ravel()), padded, [tuple(f) for f in QUADS],
                  [np.array(f) for f in QUADS]):
        assert bytes_of(gliss.Surface(CUBE, faces, "cm").nearest(probe)) == wanted
    file = tmp_path / "cube.obj"
    file.write_text("".join("v %g %g %g\n" % tuple(v) for v in CUBE) +
                    "".join("f %d %d %d %d\n" % tuple(i + 1 for i in f) for f in QUADS))
    assert bytes_of(gliss.load(file, "cm").nearest(probe)) == wanted


def test_faces_may_have_any_number_of_sides():
    prism = gliss.Surface([[np.cos(t), np.sin(t), z] for z in (0, 1) for t in np.arange(6) * np.pi / 3],
                          [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11],
                           *([i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6))], crease="40deg")
    assert prism.face_count == 8
    assert abs(prism.nearest([[0, 0, 0.9]]).distance[0] + 0.1) < 1e-9


def test_order_and_dtype_change_no_byte(knot, points):
    wanted = bytes_of(knot.nearest(points))
    table = np.zeros(len(points), [("a", "u1"), ("x", "<f8", 3)])  # not aligned
    table["x"] = points
    wide = np.zeros((len(points), 9))
    wide[:, 2:8:2] = points
    for same in (np.asfortranarray(points), points.astype(">f8"), table["x"], wide[:, 2:8:2], points[::-1][::-1],
                 points.tolist()):
        assert bytes_of(knot.nearest(same)) == wanted
    whole = np.round(points[:50])
    assert bytes_of(knot.nearest(whole.astype(np.float32))) == bytes_of(knot.nearest(whole.astype(int))) == \
        bytes_of(knot.nearest(whole))


def test_results_are_arrays_by_name(knot, points):
    c = knot.nearest(points)
    assert dict(c).keys() == c.keys() and c["point"] is c.point
    columns = c.columns()
    assert (columns["point_y"] == c.point[:, 1]).all() and (columns["domain_eta"] == c.domain[:, 1]).all()
    assert {len(column) for column in columns.values()} == {len(points)}
    assert "point: (2000, 3)" in repr(c)
    with pytest.raises(AttributeError, match="no array 'foo'"):
        c.foo


def test_nothing_of_no_points(knot):
    assert len(knot.nearest(np.zeros((0, 3))).point) == 0
    assert knot.force(np.zeros((0, 3))).shape == (0, 3)
    assert len(knot.trace(np.zeros((0, 3))).force) == 0


def test_results_and_hands_outlive_the_surface(knot_file, points):
    surface = gliss.load(knot_file, "mm")
    c, hand = surface.nearest(points), surface.hand()
    wanted = c.point.copy()
    assert c.point.flags.owndata and c.point.flags.writeable
    del surface
    gc.collect()
    assert (c.point == wanted).all() and hand.tick([60, 0, 0]).touching


def test_the_nearest_points_lie_on_the_patches(knot, points):
    c = knot.nearest(points)
    p = knot.evaluate(c.face, c.domain)
    assert np.abs(p.point - c.point).max() < 1e-9
    assert np.abs(np.cross(p.d_xi, p.d_eta) / np.linalg.norm(np.cross(p.d_xi, p.d_eta), axis=1)[:, None]
                  - p.normal).max() < 1e-9
    assert knot.evaluate(3, [[0, 0], [0.1, 0]]).point.shape == (2, 3)


def test_tessellation_lies_on_the_surface(cube):
    t = cube.tessellate(3)
    assert np.abs(cube.nearest(t.point).distance).max() < 1e-9
    assert t.triangles.max() == len(t.point) - 1 and len(t.triangles) == 6 * 8 * 9
    middle = t.point[t.triangles].mean(axis=1) - 0.5
    a, b, c = np.moveaxis(t.point[t.triangles], 1, 0)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), middle) > 0).all()
    assert np.allclose(np.linalg.norm(t.normal, axis=1), 1)


def test_other_threads_run_meanwhile(knot, points):
    many = np.tile(points, (30, 1))
    done = threading.Event()
    counted = 0

    def work():
        knot.nearest(many)
        done.set()
    thread = threading.Thread(target=work)
    thread.start()
    while not done.wait(0.001):
        counted += 1
    thread.join()
    assert counted > 20


def test_any_number_of_threads_may_ask(knot, points):
    wanted, found = bytes_of(knot.nearest(points)), []
    threads = [threading.Thread(target=lambda: found.append(bytes_of(knot.nearest(points)))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [wanted] * 4


def test_a_surface_says_what_it_is(cube):
    assert (cube.unit, cube.face_count, cube.level, cube.construction, cube.precision) == (0.01, 6, "exact", "fair", "double")
    assert (cube.bounds == [[0, 0, 0], [1, 1, 1]]).all()
    assert cube.nbytes > 0 and cube.patch_count >= 6 and cube.backend == "tbb" and cube.threads >= 1
    assert repr(cube) == "<gliss.Surface of 6 faces, fair exact, double, unit cm>"
    other = gliss.Surface(CUBE, QUADS, level="table:8", construction="paper", precision="float", backend="serial")
    assert (other.level, other.construction, other.precision, other.backend, other.unit) == (
        "table:8", "paper", "float", "serial", 1)
