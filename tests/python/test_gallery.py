"""The scripts of the gallery run, and draw where matplotlib is there."""
import importlib.util
import pathlib
import re
import subprocess
import sys

import pytest

GALLERY = pathlib.Path(__file__).resolve().parents[2] / "docs" / "gallery"
SAY = {  # words that each prints, and what the numbers among them are to be
    "plane_of_forces": (r"(\d+) of 19200 points feel a force", lambda points: 5000 < points < 6000),
    "sweep_histogram": (r"gregory .*; (\d+) jumps", lambda jumps: jumps == 0),
    "smooth_scan": (r"smooth: 30720 triangles, by ([\d.]+) degrees", lambda bend: bend < 25),
    "friction_along_a_path": (r"friction 0.3: .*the hand +(-[\d.]+) mJ", lambda work: -4 < work < -2),
    "level_by_budget": (r"ribbon +error +([\d.]+) %", lambda error: 0 < error < 0.01),
}


def test_the_gallery_is_whole():
    page = (GALLERY.parent / "python.md").read_text()
    assert {path.stem for path in GALLERY.glob("*.py")} == {*SAY, "shapes"}
    assert all(f"gallery/{name}.py" in page for name in SAY)


@pytest.mark.parametrize("name", SAY)
def test_a_script_of_the_gallery_runs(name, tmp_path):
    done = subprocess.run([sys.executable, GALLERY / f"{name}.py", "picture.png"], cwd=tmp_path, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    pattern, is_right = SAY[name]
    found = re.search(pattern, done.stdout)
    assert found and is_right(float(found[1])), done.stdout
    if importlib.util.find_spec("matplotlib"):
        assert (tmp_path / "picture.png").stat().st_size > 5000
    else:
        assert "no matplotlib" in done.stdout
