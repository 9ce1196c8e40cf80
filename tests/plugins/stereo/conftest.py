"""Pairs for the stereo tests: made up with known answers, and real ones where the data is there."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from visint.arrays import Array
from visint.io import read, read_image, read_raster


@dataclass(frozen=True)
class Pair:
    """A pair with truth: linear float32 views, true disparity (NaN unknown), and how many levels it needs."""

    left: Array
    right: Array
    truth: Array
    levels: int


def waves(rows: int, columns: int, shift: float, seed: int = 1) -> Array:
    """Sinusoids of many directions, moved right by ``shift`` px; in [0, 1], never repeating in the image."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(columns) - shift, np.arange(rows))
    image = np.zeros((rows, columns))
    for _ in range(14):
        length, angle, phase = rng.uniform(7, 40), rng.uniform(-1.2, 1.2), rng.uniform(0, 6.3)
        image += np.sin((x * np.cos(angle) + y * np.sin(angle)) * 2 * np.pi / length + phase)
    return (0.5 + image / 16).clip(0, 1).astype(np.float32)


@pytest.fixture
def shifted() -> Callable[[float], tuple[Array, Array]]:
    """shift -> (left, right) whose true disparity is ``shift`` everywhere."""
    return lambda shift: (waves(96, 160, 0), waves(96, 160, -shift))


def _data() -> Path:
    root = Path(__file__).parents[3]
    return Path(os.environ.get("VISINT_DATA", root / "../shared/data"))


SCALES = {"mb2001": 8, "mb2003": 4, "mb2005": 3, "mb2006": 3}
"""Grades to a pixel of 8-bit truth; 0 is unknown. Tsukuba has 16."""


def _truth(folder: Path) -> Array:
    file = next(folder.glob("disp_left.*"))
    if file.suffix == ".pfm":
        return read(file, "Disparity")
    grades = read_raster(file).grey.astype(np.float32)
    scale = 16 if folder.name == "tsukuba" else SCALES[folder.parent.name]
    return np.where(grades > 0, grades / scale, np.nan)


def _view(folder: Path, side: str) -> Array:
    return read_image(next(file for file in folder.glob(f"{side}.*")))


@pytest.fixture(scope="session")
def real_pair() -> Callable[[str], Pair]:
    """ "collection/scene" -> the pair; skips where the data is absent."""

    def load(scene: str) -> Pair:
        folder = _data() / scene
        if not folder.exists():
            pytest.skip(f"{scene} is not among the data; set VISINT_DATA")
        truth = _truth(folder).astype(np.float32)
        levels = -(-int(np.nanmax(truth) + 2) // 16) * 16
        return Pair(_view(folder, "left"), _view(folder, "right"), truth, levels)

    return load


@pytest.fixture(scope="session")
def public_scenes() -> list[str]:
    """All "collection/scene" of the data; skips where there are none."""
    scenes = sorted(f"{f.parent.name}/{f.name}" for f in _data().glob("mb*/*") if f.is_dir())
    return scenes or pytest.skip("no public pairs; set VISINT_DATA")


@pytest.fixture(scope="session")
def filled() -> Callable[[Array], Array]:
    """Disparity with its holes filled by the smaller row neighbour, as the peers' are."""

    def fill(disparity: Array) -> Array:
        columns = disparity.shape[1]
        known, here = np.isfinite(disparity), np.arange(columns)
        before = np.maximum.accumulate(np.where(known, here, -1), axis=1)
        after = np.minimum.accumulate(np.where(known, here, columns)[:, ::-1], axis=1)[:, ::-1]
        padded = np.pad(disparity, ((0, 0), (1, 1)), constant_values=np.inf)
        nearest = [np.take_along_axis(padded, where + 1, axis=1) for where in (before, after)]
        smaller = np.minimum(*nearest)
        return np.where(known, disparity, np.where(np.isfinite(smaller), smaller, 0))

    return fill


@pytest.fixture(scope="session")
def bad() -> Callable[[Array, Array], float]:
    """Share of pixels of known truth that are off by more than 2 px, in percent."""

    def share(disparity: Array, truth: Array) -> float:
        known = np.isfinite(truth)
        return 100 * float((~(np.abs(disparity - truth) <= 2))[known].mean())

    return share
