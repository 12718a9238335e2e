"""The Python that pages show runs."""
import pathlib
import re

import pytest

from test_loop import SCENE

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_a_page_runs(page, knot_file, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "knot.obj").write_bytes(knot_file.read_bytes())
    (tmp_path / "scene.toml").write_text(SCENE)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(), flags=re.M | re.S)
    names = {}
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert blocks and names["surface"].face_count == 1440
