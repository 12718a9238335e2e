"""Bad calls end in a Python error that says what was expected."""
import gliss
import numpy as np
import pytest

from conftest import CUBE, QUADS

NAN = float("nan")
SLIPS = [  # the call, the error, and words of its text
    (lambda s: s.nearest([1, 2]), ValueError, r"points: expected shape \(n, 3\), found \(2,\)"),
    (lambda s: s.nearest(np.zeros((3, 2))), ValueError, r"expected shape \(n, 3\), found \(3, 2\)"),
    (lambda s: s.nearest(np.zeros((2, 3, 2))), ValueError, r"expected shape \(n, 3\), found \(2, 3, 2\)"),
    (lambda s: s.nearest([[0, 0, 0], [1, NAN, 2]]), ValueError, "points: expected finite numbers, found nan in row 1"),
    (lambda s: s.nearest([[0, 0, 0], [0, 1e300, 0]]), ValueError, r"points: 1e\+300 in row 1 is beyond 1e\+60"),
    (lambda s: s.force([[0, 0, -2e60]]), ValueError, r"points: -2e\+60 in row 0 is beyond 1e\+60"),
    (lambda s: s.trace([[0, 0, 1e300]]), ValueError, r"path: 1e\+300 in row 0 is beyond 1e\+60"),
    (lambda s: s.hand().tick([0, -1e300, 0]), ValueError, r"hip: 1e\+300 is beyond 1e\+60"),
    (lambda s: s.hand().ticks([[0, 0, 1e300]]), ValueError, r"path: 1e\+300 in row 0"),
    (lambda s: s.force([[np.inf, 0, 0]]), ValueError, "expected finite numbers, found inf"),
    (lambda s: s.nearest([["a", "b", "c"]]), TypeError, "points: expected real numbers, found dtype"),
    (lambda s: s.nearest(np.zeros((1, 3), complex)), TypeError, "found dtype complex128"),
    (lambda s: s.nearest(None), TypeError, "found dtype object"),
    (lambda s: s.nearest(np.zeros((1, 3)), "smooth"), ValueError, "method: 'smooth' is not one of gregory, shaded, flat"),
    (lambda s: s.nearest(np.zeros((1, 3)), 3), TypeError, ""),
    (lambda s: s.force(np.zeros((1, 3)), -1), ValueError, "stiffness: -1 is not above 0"),
    (lambda s: s.force(np.zeros((1, 3)), NAN), ValueError, "stiffness: expected a stiffness in N/m"),
    (lambda s: s.force(np.zeros((1, 3)), "1 kg"), ValueError, "unknown unit"),
    (lambda s: s.force(np.zeros((1, 3)), None), TypeError, "stiffness: expected a stiffness in N/m"),
    (lambda s: s.evaluate(6, [[0, 0]]), ValueError, "face: 6 in row 0 is not below the number of faces, 6"),
    (lambda s: s.evaluate(-1, [[0, 0]]), ValueError, "face: expected numbers from 0"),
    (lambda s: s.evaluate(0.5, [[0, 0]]), TypeError, "face: expected whole numbers"),
    (lambda s: s.evaluate([0, 1], [[0, 0]]), ValueError, "face: expected one for each of the 1 points, found 2"),
    (lambda s: s.evaluate(0, [[2, 0]]), ValueError, r"xi_eta: \(2, 0\) in row 0 is not in the domain of face 0"),
    (lambda s: s.evaluate(0, [[NAN, 0]]), ValueError, "xi_eta: expected finite numbers"),
    (lambda s: s.tessellate(0), ValueError, "cells: 0 is not from 1 to 1000"),
    (lambda s: s.tessellate(1.5), TypeError, ""),
    (lambda s: s.trace([1, 2, 3]), ValueError, r"path: expected shape \(n, 3\)"),
    (lambda s: s.trace([[0, 0, NAN]]), ValueError, "path: expected finite numbers"),
    (lambda s: s.trace(np.zeros((1, 3)), friction=9), ValueError, "friction that is not from 0 to 5"),
    (lambda s: s.trace(np.zeros((1, 3)), friction=(0.1, 0.2)), ValueError, "dynamic friction above the static one"),
    (lambda s: s.trace(np.zeros((1, 3)), friction="much"), TypeError, "friction: expected a coefficient"),
    (lambda s: s.trace(np.zeros((1, 3)), settle=7), ValueError, "settle: 7 s is not from 0 to 1 s"),
    (lambda s: s.trace(np.zeros((1, 3)), magnet=3), TypeError, r"magnet: expected \(force, range\)"),
    (lambda s: s.trace(np.zeros((1, 3)), texture=("moon", 1, 1)), ValueError, "texture: 'moon' is not one of"),
    (lambda s: s.trace(np.zeros((1, 3)), glue=1), TypeError, r"Surface.trace\(\) has no argument 'glue'; it has path"),
    (lambda s: s.sweep(2), ValueError, "a bare number is metres"),
    (lambda s: s.sweep([]), ValueError, "depth: expected one at least"),
    (lambda s: s.sweep("1mm", methods=["smooth"]), ValueError, "methods: 'smooth' is not one of"),
    (lambda s: s.sweep("1mm", 0), ValueError, "samples: 0.* is not from 1 to 1e12"),
    (lambda s: s.sweep("1mm", rings=0), ValueError, "rings: 0 is not from 1"),
    (lambda s: s.sweep("1mm", output="samples.txt"), ValueError, "must end in .csv, .npy, .h5 or .hdf5"),
    (lambda s: s.hand().tick([1, 2]), ValueError, r"hip: expected shape \(3,\), found \(2,\)"),
    (lambda s: s.hand().tick([1, 2, NAN]), ValueError, "hip: expected finite numbers"),
    (lambda s: s.hand().tick("abc"), TypeError, "hip: expected real numbers"),
    (lambda s: s.hand().ticks([[1, 2]]), ValueError, r"path: expected shape \(n, 3\)"),
    (lambda s: gliss.Contact(), TypeError, "No constructor"),
    (lambda s: gliss.Surface(CUBE, [[0, 1, 8]]), gliss.MeshError, "vertex index 8 is out of range"),
    (lambda s: gliss.Surface(CUBE, [[0, 1, -1]]), ValueError, "faces: expected numbers from 0"),
    (lambda s: gliss.Surface(CUBE, [[0, 1, 0.5]]), TypeError, "faces: expected lists of whole numbers"),
    (lambda s: gliss.Surface(CUBE, 3), TypeError, "faces: expected lists of whole numbers"),
    (lambda s: gliss.Surface(CUBE, np.array([4, 0, 1, 2])), ValueError, "needs 1 corners more"),
    (lambda s: gliss.Surface(CUBE, np.zeros((1, 2, 3), int)), ValueError, "faces: expected shape"),
    (lambda s: gliss.Surface(CUBE, (np.array([0, 9]), np.array([0, 1, 2]))), ValueError, "expected offsets that go"),
    (lambda s: gliss.Surface(CUBE, (np.array([0, 9, 3]), np.array([0, 1, 2]))), ValueError, "expected offsets"),
    (lambda s: gliss.Surface(CUBE, (np.zeros(0, int), np.zeros(0, int))), ValueError, "expected offsets that go"),
    (lambda s: gliss.Surface(CUBE, []), gliss.MeshError, ""),
    (lambda s: gliss.Surface([[0, 0]], QUADS), ValueError, r"vertices: expected shape \(n, 3\)"),
    (lambda s: gliss.Surface([[NAN, 0, 0]] + CUBE[1:], QUADS), gliss.MeshError, "not finite"),
    (lambda s: gliss.Surface(CUBE, QUADS, "furlong"), ValueError, "furlong"),
    (lambda s: gliss.Surface(CUBE, QUADS, 0), ValueError, "unit: 0 m is not from"),
    (lambda s: gliss.Surface(CUBE, QUADS, level="best"), ValueError, "level: "),
    (lambda s: gliss.Surface(CUBE, QUADS, backend="cuda"), ValueError, "backend: 'cuda' is not one of tbb"),
    (lambda s: gliss.Surface(CUBE, QUADS, threads=-1), ValueError, "threads: -1 is not from 0"),
    (lambda s: gliss.Surface(CUBE, QUADS, threads="all"), TypeError, "threads: expected a whole number"),
    (lambda s: gliss.Surface(CUBE, QUADS, strict=3), TypeError, "strict: expected True or False, found 3"),
    (lambda s: gliss.Surface(CUBE, QUADS, crease=40), TypeError, "crease: expected text, found 40"),
    (lambda s: gliss.Surface(CUBE, QUADS, crease="none", crease_radius="1mm"), ValueError, "add which edges it rounds"),
    (lambda s: gliss.Surface(CUBE, QUADS, crease="sharp"), ValueError, "sharp"),
    (lambda s: gliss.Surface(CUBE, QUADS, backend="opencl", opencl_device="no such"), gliss.DeviceError, "no such"),
    (lambda s: gliss.Surface(CUBE, QUADS, opencl_device="some"), ValueError, "opencl_device: only the backends"),
    (lambda s: gliss.load("/nowhere.obj"), FileNotFoundError, "there is no file '/nowhere.obj'"),
    (lambda s: gliss.load("/dev"), IsADirectoryError, "'/dev' is a folder"),
    (lambda s: gliss.load(3), TypeError, ""),
    (lambda s: s.save("/nowhere/cube.gliss"), FileNotFoundError, "/nowhere/cube.gliss"),
    (lambda s: gliss.Loop("/nowhere.toml"), FileNotFoundError, "there is no file"),
]


@pytest.mark.parametrize("call, error, words", SLIPS, ids=[str(i) for i in range(len(SLIPS))])
def test_slips_are_told(cube, call, error, words):
    with pytest.raises(error, match=words) as caught:
        call(cube)
    assert "\n" not in str(caught.value) or error is TypeError


def test_a_mesh_error_tells_all_that_was_found(tmp_path):
    mesh = tmp_path / "bad.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 7\n")
    with pytest.raises(gliss.MeshError, match="bad.obj") as caught:
        gliss.load(mesh)
    assert [f["severity"] for f in caught.value.findings].count("error") >= 1
    assert gliss.MeshError("of one's own").findings == ()


def test_a_cache_must_be_what_is_asked_for(cube, tmp_path):
    path = tmp_path / "cube.gliss"
    cube.save(path)
    with pytest.raises(gliss.CacheError) as caught:
        gliss.load(path, precision="float")
    assert caught.value.stale
    with pytest.raises(ValueError, match="the unit of this cache is cm, not mm"):
        gliss.load(path, "mm")
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(gliss.CacheError) as caught:
        gliss.load(path)
    assert not caught.value.stale


def test_paths_with_a_null_character_are_refused(knot, tmp_path):
    for call in (lambda path: knot.save(path), gliss.load, lambda path: gliss.Loop(path, "sim")):
        with pytest.raises(ValueError, match="null character"):
            call(str(tmp_path / "a\0b.gliss"))
    assert not list(tmp_path.iterdir())
