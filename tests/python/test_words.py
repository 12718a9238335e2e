"""What users of NumPy and trimesh expect of a surface, and what it says by itself."""
import json
import pickle
import warnings

import gliss
from gliss import _gliss
import numpy as np
import pytest

from conftest import CUBE, QUADS


def test_points_and_grids_keep_their_shape(knot, points):
    flat, grid = knot.nearest(points), knot.nearest(points.reshape(40, 50, 3))
    assert grid.distance.shape == (40, 50) and grid.point.shape == (40, 50, 3) and grid.domain.shape == (40, 50, 2)
    assert np.array_equal(grid.point.reshape(-1, 3), flat.point)
    assert np.array_equal(knot.force(points.reshape(40, 50, 3)).reshape(-1, 3), knot.force(points))
    one = knot.nearest(points[0])
    assert one.distance.shape == () and one.distance == flat.distance[0]
    assert knot.force(points[0]).shape == (3,)
    columns = grid.columns()
    assert all(column.shape == (2000,) for column in columns.values()) and "point_x" in columns


def test_it_tells_what_it_contains(knot, points):
    contacts = knot.nearest(points)
    assert np.array_equal(knot.contains(points), contacts.distance < 0)
    assert np.array_equal(contacts.inside, contacts.distance < 0) and contacts.inside.any()
    assert knot.contains(points[0]).shape == ()


def test_contacts_have_rows_and_flags_have_names(knot, points):
    contacts = knot.nearest(points)
    assert len(contacts) == 2000 and bool(contacts)
    row = contacts[7]
    assert row["distance"] == contacts.distance[7] and np.array_equal(row["point"], contacts.point[7])
    assert sum(1 for _ in contacts) == 2000
    assert dict(contacts).keys() == contacts.keys()
    assert gliss.Flag(int(contacts.flags[7])) == gliss.Flag.CONVERGED
    assert (contacts.flags & gliss.Flag.UNFINISHED == 0).all()


def test_a_surface_has_its_mesh_and_pickles(knot, points, tmp_path):
    box = gliss.Surface(CUBE, QUADS)
    assert np.array_equal(box.vertices, CUBE)
    assert [list(face) for face in box.polygons] == QUADS
    for surface in (box, knot):
        again = pickle.loads(pickle.dumps(surface))
        assert np.array_equal(again.force(points), surface.force(points))
        assert (again.unit, again.face_count, again.precision) == (surface.unit, surface.face_count, surface.precision)


def test_a_mesh_is_checked_whatever_is_wrong_with_it(knot_file, tmp_path):
    assert gliss.check(knot_file, unit="mm") == []
    assert [f["severity"] for f in gliss.check(CUBE, [*QUADS, QUADS[0]])] == ["repaired"]
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 7\n")
    assert "error" in [f["severity"] for f in gliss.check(bad)]


def test_slips_in_options_name_the_one_that_is_meant(knot):
    for call, meant in ((lambda: knot.hand(fricton=0.3), "friction"),
                        (lambda: gliss.Surface(CUBE, QUADS, creases="auto"), "crease"),
                        (lambda: knot.trace(np.zeros((1, 3)), setle=0), "settle")):
        with pytest.raises(TypeError, match=f"did you mean '{meant}'"):
            call()


@pytest.mark.parametrize("made_by_functions", [gliss.Contact, _gliss.OpenSurface, _gliss.OpenHand, _gliss.OpenLoop])
def test_nothing_is_there_that_was_never_set(made_by_functions):
    for make in (made_by_functions, lambda: made_by_functions.__new__(made_by_functions)):
        with pytest.raises(TypeError, match="No constructor"):
            make()


def test_masks_are_refused_for_they_would_be_lost(knot, points):
    with pytest.raises(TypeError, match="points: a masked array"):
        knot.nearest(np.ma.masked_array(points, mask=points > 0))


def test_it_warns_of_what_the_program_says(knot_file):
    with pytest.warns(UserWarning, match="m across: its unit may be another"):
        gliss.load(knot_file)
    with pytest.warns(UserWarning, match="repaired: "):
        gliss.Surface(CUBE, [*QUADS, QUADS[0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gliss.load(knot_file, unit="mm")


def test_compare_measures_what_the_program_does(program, tmp_path):
    program("generate", "goldberg", "--frequency", "2", "-o", tmp_path / "ball.obj")
    told = []
    found = gliss.load(tmp_path / "ball.obj", unit="mm").compare(
        surfaces=["fair", "paper-ribbon", "flat"], precisions="double", depth="0.5mm", walks=2, walk_ticks=200, dense_limit=0,
        progress=lambda done, total: told.append((done, total)))
    assert [row["surface"] for row in found["rows"]] == ["fair", "paper-ribbon", "flat"]
    words = ["--levels", "fair,paper-ribbon,flat", "--precisions", "double", "--depth", "0.5mm", "--walks", "2",
             "--walk-ticks", "200", "--dense-limit", "0", "--json", "--quiet"]
    same = json.loads(program("compare", tmp_path / "ball.obj", "--unit", "mm", *words))
    for row, other in zip(found["rows"], same["rows"]):  # times differ
        assert row["max_force_error"] == other["max_force_error"] and row["walks"] == other["walks"]
    assert found["recommended"]["surface"] == "fair" and "jumps" in found["reason"]
    assert told[-1] == (3, 3)
    with pytest.raises(ValueError, match="surfaces: 'best' is not one of fair, paper"):
        gliss.Surface(CUBE, QUADS).compare(surfaces="best")


def test_progress_is_told_and_may_end_the_work(knot, capsys):
    told = []
    knot.sweep("1mm", rings=4, progress=lambda done, total: told.append((done, total)))
    assert told and told[-1][0] == told[-1][1] > 0
    knot.sweep("1mm", rings=2, progress=True)
    assert "gliss: sweep: 100 %" in capsys.readouterr().err

    def stop(done, total):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        knot.sweep("1mm", rings=4, progress=stop)
    with pytest.raises(TypeError, match="progress: expected a function"):
        knot.sweep("1mm", progress=3)


def test_old_names_work_for_a_version():
    cube = gliss.Surface(CUBE, QUADS)
    with pytest.warns(DeprecationWarning, match="Surface.faces is Surface.face_count now"):
        assert cube.faces == cube.face_count == 6
    with pytest.warns(DeprecationWarning):
        assert cube.patches == cube.patch_count
