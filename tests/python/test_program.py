"""The package gives the bytes of the program."""
import json
import shlex

import gliss
import h5py
import numpy as np
import pytest


def same(mine, table, names):
    """Holds that an array has the bytes of the columns of these names."""
    theirs = np.column_stack([table[name] for name in names]) if len(names) > 1 else table[names[0]]
    assert np.ascontiguousarray(mine).astype(theirs.dtype).tobytes() == theirs.tobytes(), names


@pytest.mark.parametrize("method", ["gregory", "shaded", "flat"])
def test_nearest_and_force_are_those_of_project(knot, knot_file, points, program, tmp_path, method):
    np.save(tmp_path / "hips.npy", points)
    program("project", knot_file, "--hip", tmp_path / "hips.npy", "--unit", "mm", "--method", method, "--stiffness",
            "0.7N/mm", "-o", tmp_path / "nearest.npy", "--quiet")
    table = np.load(tmp_path / "nearest.npy")
    c = knot.nearest(points, method)
    same(c.face, table, ["face"])
    same(c.domain, table, ["xi", "eta"])
    same(c.point, table, ["x", "y", "z"])
    same(c.normal, table, ["nx", "ny", "nz"])
    same(c.distance, table, ["distance"])
    same(c.iterations, table, ["iterations"])
    same(c.flags, table, ["flags"])
    same(knot.force(points, "0.7N/mm", method), table, ["fx", "fy", "fz"])
    assert (c.distance[c.touching] < 0).all() and c.touching.any() and not c.touching.all()


@pytest.mark.parametrize("words, options", [
    ([], {}),
    (["--settle", "0", "--friction", "0.5,0.3", "--friction-settle", "2ms"],
     {"settle": 0, "friction": (0.5, 0.3), "friction_settle": "2ms"}),
    (["--damping", "2s/m", "--viscosity", "1Ns/m", "--magnet", "0.5N,2mm", "--texture", "grating,50um,2mm,0,1,0"],
     {"damping": 2, "viscosity": "1Ns/m", "magnet": ("0.5N", 2e-3), "texture": ("grating", 50e-6, "2mm", (0, 1, 0))})])
def test_trace_is_that_of_the_program(knot, knot_file, path, program, tmp_path, words, options):
    np.save(tmp_path / "path.npy", path)
    program("trace", knot_file, "--path", tmp_path / "path.npy", "--unit", "mm", "--method", "gregory",
            "--stiffness", "0.6N/mm", *words, "-o", tmp_path / "trace.npy", "--quiet")
    table = np.load(tmp_path / "trace.npy")
    t = knot.trace(path, "0.6N/mm", **options)
    same(t.force, table, ["fx", "fy", "fz"])
    same(t.point, table, ["scp_x", "scp_y", "scp_z"])
    same(t.face, table, ["face"])
    assert (table["patch"] == table["face"]).all()  # its old name
    assert (t.touching == (table["state"] == b"contact")).all() and t.touching.any()
    if "friction" in options:
        same(t.cone_share, table, ["cone_share"])
        assert (t.slipping == (table["grip"] == b"slip")).all() and t.slipping.any()
    assert t.statistics["ticks"] == len(path) and t.statistics["in_contact"] == t.touching.sum()


def test_hand_feels_what_trace_does(knot, path):
    options = {"friction": 0.4, "damping": 2}
    t = knot.trace(path, **options)
    hand = knot.hand(**options)
    ticks = [hand.tick(hip) for hip in path[:500]]
    rest = hand.ticks(path[500:])
    # By way of metres, a path changes by rounding.
    assert np.abs(np.array([c.force for c in ticks]) - t.force[:500]).max() < 1e-9
    assert np.abs(rest.force - t.force[500:]).max() < 1e-9
    assert [c.touching for c in ticks] == t.touching[:500].tolist()


@pytest.mark.parametrize("ending", [".h5", ".csv", ".npy"])
def test_sweep_writes_the_file_of_the_program(knot_file, program, tmp_path, monkeypatch, ending):
    monkeypatch.chdir(knot_file.parent)
    knot = gliss.load("knot.obj", "mm", threads=1)
    mine = knot.sweep(["2mm", 4e-3], 3000, methods=["gregory", "flat"], output="mine" + ending)
    first = open("mine" + ending, "rb").read()
    words = "gliss sweep knot.obj --depth 2mm,4mm --samples 3000 --method gregory,flat --unit mm -o mine".split()
    if ending == ".h5":
        with h5py.File("mine.h5") as file:
            assert file.attrs["command_line"].decode() == " ".join(words) + ending
            assert len(file["depth_2mm/gregory/fx"]) >= 3000
    program(*words[1:-1], "mine" + ending)
    assert open("mine" + ending, "rb").read() == first
    assert json.loads(program(*words[1:-2], "--json", "--quiet"))["statistics"] == mine.statistics
    assert mine.histograms[0]["step"].sum() == mine.statistics[0]["step_N"]["count"]
    assert len(mine.bin_edges) == len(mine.histograms[0]["step"])


@pytest.mark.parametrize("file, options", [
    ("knot.obj", dict(unit=1e-3, level="table", precision="float", weld=False, strict=True, crease="60deg")),
    ("knot.gliss", {})])
def test_a_sweep_names_the_command_that_makes_its_file(knot, knot_file, program, monkeypatch, file, options):
    monkeypatch.chdir(knot_file.parent)
    knot.save("knot.gliss")
    gliss.load(file, **options).sweep(1e-3, rings=2, methods="shaded", stiffness=700, output="named.h5")
    first = open("named.h5", "rb").read()
    with h5py.File("named.h5") as named:
        words = shlex.split(named.attrs["command_line"].decode())
    program(*words[1:])
    assert open("named.h5", "rb").read() == first


def test_findings_are_those_of_check(program, tmp_path):
    mesh = tmp_path / "open.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 3 4\n")
    assert gliss.load(mesh).findings == json.loads(program("check", mesh, "--json", "--quiet"))["findings"]


def test_caches_go_both_ways(knot, knot_file, points, program, tmp_path):
    knot.save(tmp_path / "mine.gliss")
    program("bake", knot_file, "--unit", "mm", "-o", tmp_path / "theirs.gliss", "--quiet")
    assert (tmp_path / "mine.gliss").read_bytes() == (tmp_path / "theirs.gliss").read_bytes()
    cache = gliss.load(tmp_path / "theirs.gliss")
    assert cache.nearest(points).point.tobytes() == knot.nearest(points).point.tobytes()
    assert cache.tessellate(2).triangles.shape == knot.tessellate(2).triangles.shape
