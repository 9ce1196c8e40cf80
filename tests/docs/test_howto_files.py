"""The pages on what goes in and what comes out are run, block after block, each in an empty folder."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

HOWTO = Path(__file__).parents[2] / "docs" / "howto"
EXTRAS = ("open3d",)
"""Libraries that a block may want and that the tests do without."""


@pytest.mark.parametrize("page", ["own-camera.md", "read-the-artifacts.md"])
@pytest.mark.filterwarnings("ignore::ResourceWarning")  # the pages open a file in one line, as people do
def test_the_page_runs(page, tmp_path, monkeypatch):
    """Every Python block, in one session."""
    monkeypatch.chdir(tmp_path)
    session: dict[str, object] = {"__name__": page}
    blocks = re.findall(r"^```python\n(.*?)^```", (HOWTO / page).read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) > 4
    for code in blocks:
        if any(f"import {extra}" in code and find_spec(extra) is None for extra in EXTRAS):
            continue
        exec(compile(code, page, "exec"), session)


def test_matlab_reads_files_that_are_there():
    """What cannot be run here names files that the page's own run leaves."""
    text = (HOWTO / "read-the-artifacts.md").read_text()
    matlab = "".join(re.findall(r"^```matlab\n(.*?)^```", text, re.DOTALL | re.MULTILINE))
    named = set(re.findall(r"out/([\w.]+)", matlab))
    assert named == {"disparity.png", "points.ply"}
    assert all(f'"out/{name}"' in text for name in named)
