"""A small pair on disk, the program called in this process, and readers that owe nothing to visint.io."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import cv2
import numpy as np
import pytest

from visint.cli.main import main
from visint.testing import installed

SHIFT, ROWS, COLUMNS = 5, 48, 64
ROOT = Path(__file__).parents[2]


class Outcome(NamedTuple):
    """What a user sees of a call."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


class Pair(NamedTuple):
    """The files of a pair, and the options that name them."""

    folder: Path

    def __getattr__(self, name: str) -> Any:
        return str(self.folder / {"calib": "calib.txt"}.get(name, f"{name}.png"))

    @property
    def images(self) -> list[str]:
        return ["--left", self.left, "--right", self.right]

    @property
    def all(self) -> list[str]:
        return [*self.images, "--calib", self.calib]


def texture(rows: int, columns: int, seed: int = 0) -> np.ndarray:
    """Smooth noise in [0, 1], as fine as a photograph."""
    noise = np.random.default_rng(seed).random((rows, columns), np.float32)
    return cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 1.0), None, 0, 1, cv2.NORM_MINMAX)


def calibration(rows: int = ROWS, columns: int = COLUMNS, **changed: object) -> str:
    """Middlebury's format; ``None`` leaves a line out."""
    matrix = f"[100 0 {(columns - 1) / 2}; 0 100 {(rows - 1) / 2}; 0 0 1]"
    lines = {"cam0": matrix, "cam1": matrix, "doffs": 0, "baseline": 50, "width": columns, "height": rows}
    lines |= {"ndisp": 16, **changed}
    return "".join(f"{name}={value}\n" for name, value in lines.items() if value is not None)


@pytest.fixture(scope="session")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Pair:
    """A fronto-parallel wall: the right image is the left one, SHIFT pixels further left."""
    folder = tmp_path_factory.mktemp("pair")
    wall = (texture(ROWS, COLUMNS + SHIFT) * 255).astype(np.uint8)
    cv2.imwrite(str(folder / "left.png"), wall[:, :COLUMNS])
    cv2.imwrite(str(folder / "right.png"), wall[:, SHIFT:])
    (folder / "calib.txt").write_text(calibration())
    return Pair(folder)


@pytest.fixture
def visint(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Callable[..., Outcome]:
    """The program, called in this process in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: object) -> Outcome:
        capsys.readouterr()
        code = main([str(one) for one in arguments])
        return Outcome(code, *capsys.readouterr())

    return call


@pytest.fixture
def process() -> Callable[..., subprocess.CompletedProcess[str]]:
    """A fresh process: ``process("-m", "visint", ...)``."""

    def call(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, **options.pop("env", {})}
        return subprocess.run(
            [sys.executable, *arguments],
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
            env=environment,
            **options,
        )

    return call


@pytest.fixture
def toys() -> Iterator[Path]:
    """The toy modules, installed under ``toy``; yields what to put on PYTHONPATH for another process."""
    with installed("toys", plugins={"toy": "visint.testing.plugin"}) as folder:
        yield folder


@pytest.fixture(scope="session")
def former(pair: Pair, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run of ``stereo_sgm`` on the pair; not to be changed."""
    out = tmp_path_factory.mktemp("former") / "out"
    assert main(["run", "stereo_sgm", *pair.all, "--out", str(out), "-q"]) == 0
    return out


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below ``folder``, hidden ones too."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def read_pfm(path: Path) -> np.ndarray:
    """A PFM file as Middlebury's page describes it: rows from the bottom up."""
    head = re.match(rb"(P[Ff])\s+(\d+)\s+(\d+)\s+(-?[\d.]+)\s", data := path.read_bytes())
    assert head is not None
    columns, rows, scale = int(head[2]), int(head[3]), float(head[4])
    values = np.frombuffer(data[head.end() :], "<f4" if scale < 0 else ">f4")
    return values.reshape((rows, columns) if head[1] == b"Pf" else (rows, columns, 3))[::-1]


def read_ply(path: Path) -> np.ndarray:
    """The vertices of a binary little-endian PLY, as a structured array."""
    head, _, body = path.read_bytes().partition(b"end_header\n")
    lines = [line.split() for line in head.decode().splitlines()]
    assert lines[0] == ["ply"]
    assert ["format", "binary_little_endian", "1.0"] in lines
    types = {"float": "<f4", "double": "<f8", "uchar": "u1"}
    fields = [(line[2], types[line[1]]) for line in lines if line[0] == "property"]
    count = next(int(line[2]) for line in lines if line[:2] == ["element", "vertex"])
    assert len(body) == count * np.dtype(fields).itemsize
    return np.frombuffer(body, np.dtype(fields))


@pytest.fixture
def refused(visint: Callable[..., Outcome], tmp_path: Path) -> Callable[..., str]:
    """Calls the program, which must refuse; gives what it said, that being short and to the point."""

    def call(code: int, *arguments: object) -> str:
        before = contents(tmp_path)
        outcome = visint(*arguments)
        assert outcome.code == code, outcome
        assert outcome.out == ""
        assert 1 <= len(outcome.err.splitlines()) <= 16
        assert "Traceback" not in outcome.err
        assert "array(" not in outcome.err
        assert contents(tmp_path) == before
        assert not [entry for entry in tmp_path.iterdir() if entry.name.startswith(".visint")]
        return outcome.err

    return call


@pytest.fixture(scope="session")
def files() -> SimpleNamespace:
    """The functions above, for tests."""
    return SimpleNamespace(
        pfm=read_pfm, ply=read_ply, contents=contents, calibration=calibration, texture=texture, root=ROOT
    )
