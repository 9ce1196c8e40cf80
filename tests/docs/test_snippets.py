"""Every page is run as a reader would: its Python, its calls of the program, its files, in one folder."""

from __future__ import annotations

import contextlib
import io as text_io
import os
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from visint import io
from visint.cli.main import main
from visint_lab.render.rendering import render
from visint_lab.scenes.demonstration import sphere_before_plane

ROOT = Path(__file__).parents[2]
OWN_TESTS = {
    "write-a-module.md",  # tests/thirdparty installs what it builds
    *("own-camera.md", "read-the-artifacts.md"),  # test_howto_files has the rigs and readers that they need
}
ELSEWHERE = ("make ", "python3 ", "pip ", ".venv/", ". .venv", "cd ", "#", "git ", "rerun ")
"""How lines of a console begin that are for a machine without visint, or for another program."""


class Block(NamedTuple):
    """A fenced block: its language, its text, and the line of the page it begins at."""

    language: str
    text: str
    line: int


def blocks_of(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page in order."""
    text = page.read_text(encoding="utf-8")
    for found in re.finditer(r"^```(\w+)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        yield Block(found[1], found[2], text.count("\n", 0, found.start()) + 1)


def run_page(page: Path) -> dict[str, Any]:
    """Runs a page in the folder that is current: files are written, programs called, Python is one session.

    A block whose first line is ``# NAME.yaml`` is that file. A line of a console is a call of ``visint``;
    what it prints may go to a file (``> NAME``).
    """
    session: dict[str, Any] = {"__name__": page.stem}
    for block in blocks_of(page):
        if block.language == "python":
            exec(compile("\n" * block.line + block.text, page.name, "exec"), session)
        elif block.language == "console":
            for line in block.text.splitlines():
                _call(line, f"{page.name}:{block.line}")
        elif named := re.match(r"# ([\w-]+\.(?:yaml|txt))\n", block.text):
            Path(named[1]).write_text(block.text, encoding="utf-8")
    return session


def _call(line: str, where: str) -> None:
    if not line.strip() or line.startswith(ELSEWHERE):
        return
    words = shlex.split(line, comments=True)
    expected = 0
    if words[0] == "!":  # a call that is meant to fail
        words, expected = words[1:], 2
    assert words[0] == "visint", f"{where}: {line!r} is no call of visint"
    target = words[words.index(">") + 1] if ">" in words else os.devnull
    words = words[: words.index(">")] if ">" in words else words
    said = text_io.StringIO()
    with Path(target).open("w") as out, contextlib.redirect_stdout(out), contextlib.redirect_stderr(said):
        code = main(words[1:])
    assert code == expected, f"{where}: {line!r} left with {code}: {said.getvalue()}"


PAGES = [
    page
    for page in sorted([*(ROOT / "docs").rglob("*.md"), ROOT / "README.md"])
    if not {"generated", "_build"} & set(page.parts)
    and page.name not in OWN_TESTS
    and any(block.language in ("python", "console") for block in blocks_of(page))
]


@pytest.fixture(scope="session")
def files():
    """What a reader has at hand: a pair, its calibration."""
    pair = render(sphere_before_plane(size=96, seed=0))
    camera = pair.camera
    matrix = f"[{camera.focal_length} 0 {camera.cx}; 0 {camera.focal_length} {camera.cy}; 0 0 1]"
    low, high = camera.disparity_range
    lines = {"cam0": matrix, "cam1": matrix, "doffs": camera.doffs, "baseline": camera.baseline}
    lines |= {"width": camera.width, "height": camera.height, "vmin": low, "vmax": high}
    return {
        "left.png": io.encode_png(io.srgb_from_linear(pair.left)),
        "right.png": io.encode_png(io.srgb_from_linear(pair.right)),
        "calib.txt": "".join(f"{name}={value}\n" for name, value in lines.items()).encode(),
    }


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_it_runs(page, files, tmp_path, monkeypatch):
    """In an empty folder that holds left.png, right.png and calib.txt."""
    monkeypatch.chdir(tmp_path)
    for name, data in files.items():
        io.write_bytes(tmp_path / name, data)
    run_page(page)


def test_the_pages_that_teach_are_among_them():
    taught = {"first-depth-map", "own-graph", "textureless-objects", "compare-two-systems", "loops", "evidence"}
    assert taught <= {page.stem for page in PAGES}
