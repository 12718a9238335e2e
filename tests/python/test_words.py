"""What users of NumPy and trimesh expect of a surface, and what it says by itself."""
import inspect
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


WRONG_KEYWORDS = [  # the call, its name, what it was given, and what is meant
    (lambda s: s.hand(fricton=0.3), "Surface.hand", "fricton", "friction"),
    (lambda s: s.hand(stifness=500), "Surface.hand", "stifness", "stiffness"),
    (lambda s: gliss.Hand(s, metod="flat"), "Hand", "metod", "method"),
    (lambda s: s.hand().tick(hpi=[0, 0, 0]), "Hand.tick", "hpi", "hip"),
    (lambda s: s.hand().tick([0, 0, 0], dts=1e-3), "Hand.tick", "dts", "dt"),
    (lambda s: s.hand().ticks([[0, 0, 0]], pth=0), "Hand.ticks", "pth", "path"),
    (lambda s: gliss.Surface(CUBE, QUADS, creases="auto"), "Surface", "creases", "crease"),
    (lambda s: gliss.Surface(vertexes=CUBE, faces=QUADS), "Surface", "vertexes", "vertices"),
    (lambda s: gliss.load("a.obj", units="mm"), "load", "units", "unit"),
    (lambda s: gliss.load("a.obj", **{"crease-radius": 1}), "load", "crease-radius", "crease_radius"),
    (lambda s: gliss.check("a.obj", treads=1), "check", "treads", "threads"),
    (lambda s: s.trace(np.zeros((1, 3)), setle=0), "Surface.trace", "setle", "settle"),
    (lambda s: s.trace(np.zeros((1, 3)), progres=True), "Surface.trace", "progres", "progress"),
    (lambda s: s.nearest(np.zeros((1, 3)), metod="flat"), "Surface.nearest", "metod", "method"),
    (lambda s: s.nearest(point=np.zeros((1, 3))), "Surface.nearest", "point", "points"),
    (lambda s: s.nearest(hip=np.zeros((1, 3))), "Surface.nearest", "hip", "points"),  # as the program has it
    (lambda s: s.evaluate(0, at=[[0, 0]]), "Surface.evaluate", "at", "xi_eta"),  # the same
    (lambda s: s.sweep("1mm", sample=10), "Surface.sweep", "sample", "samples"),
    (lambda s: s.sweep("1mm", method="flat"), "Surface.sweep", "method", "methods"),
    (lambda s: s.compare(depths="1mm"), "Surface.compare", "depths", "depth"),
    (lambda s: s.compare(levels="fair"), "Surface.compare", "levels", "surfaces"),  # the same
    (lambda s: gliss.Loop("scene.toml", devise="sim"), "Loop", "devise", "device"),
    (lambda s: gliss.Loop("scene.toml", no_wait=True), "Loop", "no_wait", "wait"),  # the same
]


@pytest.mark.parametrize("call, name, given, meant", WRONG_KEYWORDS, ids=[f"{r[1]}-{r[2]}" for r in WRONG_KEYWORDS])
def test_a_wrong_keyword_names_the_one_that_is_meant(cube, call, name, given, meant):
    with pytest.raises(TypeError) as caught:
        call(cube)
    assert str(caught.value) == f"{name}() has no argument '{given}': did you mean '{meant}'?"
    assert caught.value.__cause__ is None and caught.value.__context__ is None


def public_functions():
    """Functions and methods that a user calls, of classes that a user makes."""
    yield from (gliss.load, gliss.check)
    for made in (gliss.Surface, gliss.Hand, gliss.Loop, gliss.Results):
        for name, member in vars(made).items():
            is_public = name == "__init__" if name.startswith("_") else True
            if inspect.isfunction(member) and is_public and member is not gliss.Results.__init__:
                yield member


@pytest.mark.parametrize("function", public_functions(), ids=lambda function: function.__qualname__)
def test_any_public_function_tells_of_a_wrong_keyword(function):
    signature = inspect.signature(function)
    assert all(p.kind is not p.VAR_KEYWORD for p in signature.parameters.values()), "hidden from help()"
    needed = [None for p in signature.parameters.values() if p.default is p.empty and p.kind is p.POSITIONAL_OR_KEYWORD]
    for given in (needed, needed[:1]):
        with pytest.raises(TypeError, match=r"\(\) has no argument 'qqqq'; it has "):
            function(*given, qqqq=1)


def test_help_lists_the_keywords():
    for function in (gliss.load, gliss.check, gliss.Surface):
        keywords = inspect.signature(function).parameters
        assert keywords["crease_radius"].kind is inspect.Parameter.KEYWORD_ONLY
        assert keywords["orient"].default == "outward"
        for name in keywords:
            assert name in ("mesh", "path", "faces", "vertices") or name in gliss.load.__doc__, name
    for function in (gliss.Surface.trace, gliss.Surface.hand, gliss.Hand):
        keywords = inspect.signature(function).parameters
        assert keywords["friction_settle"].default == 0 and "texture" in keywords
    assert str(inspect.signature(gliss.Hand.tick)) == "(self, hip, dt=0.001)"


def test_orient_and_flip_turn_parts():
    faces = [face[::-1] for face in QUADS]
    turned, room = (gliss.Surface(CUBE, faces, unit="mm", orient=orient) for orient in ("outward", "file"))
    corners = np.asarray(CUBE, float)
    inside = [corners.mean(axis=0)]
    assert turned.nearest(inside).distance[0] < 0 < room.nearest(inside).distance[0]
    skin, flipped = (gliss.Surface(CUBE, faces[:1], unit="mm", flip=flip) for flip in (False, True))
    side = corners[list(QUADS[0])].mean(axis=0)
    near = [side + 0.1 * (corners.mean(axis=0) - side)]
    assert flipped.nearest(near).distance[0] < 0 < skin.nearest(near).distance[0]


def test_other_type_errors_stay_as_they_were(knot):
    with pytest.raises(TypeError, match=r"Surface.nearest\(\) missing 1 required positional argument: 'points'"):
        knot.nearest()
    with pytest.raises(TypeError, match="points: expected real numbers"):
        knot.nearest(points="abc")


@pytest.mark.parametrize("made_by_functions", [gliss.Contact, _gliss.OpenSurface, _gliss.OpenHand, _gliss.OpenLoop])
def test_nothing_is_there_that_was_never_set(made_by_functions):
    for make in (made_by_functions, lambda: made_by_functions.__new__(made_by_functions)):
        with pytest.raises(TypeError, match="No constructor"):
            make()


def test_masks_are_refused_for_they_would_be_lost(knot, points):
    masked = np.ma.masked_array(points, mask=points > 0)
    with pytest.raises(TypeError, match="points: a masked array, whose mask would be lost"):
        knot.nearest(masked)
    with pytest.raises(TypeError, match="points: a masked array"):
        knot.nearest(list(masked))
    with pytest.raises(TypeError, match="^hip: a masked array, whose mask would be lost"):
        knot.hand().tick(masked[0])


def test_faces_with_a_mask_are_refused():
    quads = np.ma.masked_array(QUADS, mask=np.eye(6, 4, dtype=bool))
    offsets, corners = np.arange(0, 25, 4), quads.ravel()
    padded = np.ma.masked_array(np.insert(np.array(QUADS), 0, 4, axis=1).ravel())
    for faces in (quads, list(quads), tuple(quads), (offsets, corners), padded):
        with pytest.raises(TypeError, match="^faces: a masked array, whose mask would be lost"):
            gliss.Surface(CUBE, faces)
    with pytest.raises(TypeError, match="^vertices: a masked array"):
        gliss.Surface(np.ma.masked_array(CUBE), QUADS)
    with pytest.raises(TypeError, match="^face: a masked array"):
        gliss.Surface(CUBE, QUADS, "cm").evaluate(np.ma.masked_array([0]), [[0, 0]])


@pytest.mark.parametrize("precision", ["double", "float"])
def test_what_has_converged_has_a_distance(precision):
    away = 10.0 ** np.arange(0, 61, 2)
    contacts = gliss.Surface(CUBE, QUADS, "cm", precision=precision).nearest(np.outer(away, [1, 1, -1]))
    converged = contacts.flags & gliss.Flag.CONVERGED != 0
    assert np.isfinite(contacts.distance[converged]).all() and converged[:8].all()
    assert converged.all() or precision == "float"


def test_it_warns_of_what_the_program_says(knot_file):
    with pytest.warns(UserWarning, match="m across: its unit may be another"):
        gliss.load(knot_file)
    with pytest.warns(UserWarning, match="repaired: "):
        gliss.Surface(CUBE, [*QUADS, QUADS[0]])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gliss.load(knot_file, unit="mm")


def test_it_suggests_creases(tmp_path):
    with pytest.warns(UserWarning, match="^12 edges are kept sharp; crease='none' makes the surface smooth all over$"):
        gliss.Surface(CUBE, QUADS, "cm")
    # A spindle: its sides turn by 9 degrees from one to the next, and by 60 to the cones at its ends.
    n = 40
    turns = np.arange(n) * 2 * np.pi / n
    rim = np.column_stack([np.cos(turns), np.sin(turns), 0 * turns])
    vertices = np.vstack([rim, rim + [0, 0, 1], [[0, 0, -0.577], [0, 0, 1.577]]])
    faces = [face for i, j in zip(range(n), [*range(1, n), 0])
             for face in ([i, j, n + j, n + i], [j, i, 2 * n], [n + i, n + j, 2 * n + 1])]
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        surface = gliss.Surface(vertices, faces, "cm")
    assert [str(w.message) for w in told] == [
        "the edges of this mesh turn by much less than 34 degrees or by much more, as a machine part's do: "
        "crease='auto' keeps the latter sharp"]
    file = tmp_path / "spindle.obj"
    file.write_text("".join("v %r %r %r\n" % tuple(v) for v in vertices.tolist()) +
                    "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces))
    same = gliss.load(file, "cm", crease="auto")
    assert surface.creases == 0 and same.creases == 2 * n


def test_lengths_in_warnings_have_a_unit():
    plate = np.array(CUBE) * [100, 100, 1]
    for unit, said in (("mm", "by 589 um, and the next face is 1 mm away"), ("in", "by 15 mm, .* is 25.4 mm away")):
        with pytest.warns(UserWarning, match="the surface leaves face 4 " + said):
            gliss.Surface(plate, QUADS, unit, crease="none")


def test_warnings_stand_at_the_line_of_the_user(knot_file):
    cube = gliss.Surface(CUBE, QUADS, "cm")
    for call in (lambda: gliss.Surface(CUBE, QUADS, "cm"), lambda: gliss.load(knot_file), lambda: cube.faces):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            call()
        assert {(w.filename, w.lineno) for w in told} == {(__file__, call.__code__.co_firstlineno)}


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


def test_traces_and_builds_tell_their_progress(knot, knot_file, path, tmp_path, capsys):
    told = []

    def tell(done, total):
        told.append((done, total))

    assert np.array_equal(knot.trace(path, progress=tell).force, knot.trace(path).force)
    assert told[-1] == (len(path), len(path))
    for make in (lambda: gliss.load(knot_file, "mm", progress=tell),
                 lambda: gliss.check(knot_file, unit="mm", progress=tell),
                 lambda: gliss.Surface(knot.vertices, knot.polygons, "mm", progress=tell)):
        told.clear()
        make()
        assert told and told[-1] == (knot.face_count, knot.face_count)
    gliss.load(knot_file, "mm", progress=True)
    assert "gliss: build: 100 %" in capsys.readouterr().err

    def stop(done, total):
        raise KeyError("enough")

    for work in (lambda: gliss.load(knot_file, "mm", progress=stop), lambda: knot.trace(path, progress=stop)):
        with pytest.raises(KeyError, match="enough"):
            work()
    told.clear()
    knot.save(tmp_path / "knot.gliss")
    gliss.load(tmp_path / "knot.gliss", progress=tell)
    assert not told
    loaded = gliss.load(knot_file, "mm", progress=tell)  # the program's command has no such option
    assert loaded._words == knot._words


def test_old_names_work_for_a_version():
    cube = gliss.Surface(CUBE, QUADS)
    with pytest.warns(DeprecationWarning, match="Surface.faces is Surface.face_count now"):
        assert cube.faces == cube.face_count == 6
    with pytest.warns(DeprecationWarning):
        assert cube.patches == cube.patch_count
