"""KITTI's calibrations: ``P0:`` … of a rectified pair, and ``calib_cam_to_cam.txt`` of the rig (Geiger et al.
2013, DOI 10.1177/0278364913491297). Lengths are metres; cameras 0 and 1 are grey, 2 and 3 coloured.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.errors import InputError, Problem, Where
from visint.fields.camera import Camera
from visint.io.rectification import View, pair_camera

__all__ = ["kitti_calibration"]

_NUMBER = re.compile(r"[-+]?(?:\d{1,40}\.?\d{0,40}|\.\d{1,40})(?:[eE][-+]?\d{1,3})?\Z", re.ASCII)
_PAIRS = ((2, 3), (0, 1))
_COUNTS = {"S": 2, "K": 9, "D": 5, "S_rect": 2, "R_rect": 9, "P_rect": 12}
_BOTH = (
    "of the four cameras in the calibration the colour ones, 2 and 3, were taken; for the grey ones give a "
    "calibration without these"
)
_SAYS_RECTIFIED = (
    "the images are of the size that KITTI's cameras take, and were rectified by the calibration; all maps are "
    "of the rectified left image"
)


class _Line(NamedTuple):
    numbers: Array | None
    line: int


def kitti_calibration(
    text: str, name: str, size: tuple[int, int] | None
) -> tuple[Camera, tuple[View, View] | None, tuple[str, ...]]:
    """Camera, views and remarks from the text of a KITTI calibration.

    Parameters
    ----------
    size
        (rows, columns) of the images. A ``calib_cam_to_cam.txt`` has two sizes: images of the one are
        rectified already, those of the other not yet.

    Raises
    ------
    InputError
        VI306 with the line of what is missing or wrong.
    """
    sheet = _Sheet(name, dict(_lines(text)))
    whole = any(key.startswith("P_rect_") for key in sheet.lines)
    spelled = "P_rect_0{}" if whole else "P{}"
    pairs = [pair for pair in _PAIRS if all(spelled.format(camera) in sheet.lines for camera in pair)]
    if not pairs:
        raise sheet.wrong(
            spelled.format(0), f"and {spelled.format(1)} are missing, or those of cameras 2 and 3"
        )
    projections = [sheet.matrix(spelled.format(camera), 12).reshape(3, 4) for camera in pairs[0]]
    sizes = sheet.sizes(pairs[0]) if whole else None
    rectified = sizes[1] if sizes else size
    if rectified is None:
        raise sheet.wrong("", "does not say the size of the images, and there are no images to ask")
    camera = pair_camera(projections[0], projections[1], rectified, "m")
    if camera is None:
        raise sheet.wrong(
            spelled.format(pairs[0][1]), "wants −f · baseline in its fourth number, below the left's"
        )
    remarks = (_BOTH,) if len(pairs) > 1 else ()
    if sizes is None or size is None or size != sizes[0] or size == sizes[1]:
        return camera, None, remarks
    left, right = (sheet.view(one, projections[i], size) for i, one in enumerate(pairs[0]))
    return camera, (left, right), (*remarks, _SAYS_RECTIFIED)


def _lines(text: str) -> Iterable[tuple[str, _Line]]:
    for line, words in enumerate(text.splitlines(), start=1):
        key, _, value = words.partition(":")
        numbers = value.split()
        good = 0 < len(numbers) < 20 and all(_NUMBER.match(one) for one in numbers)
        yield key.strip(), _Line(np.array(numbers, dtype=np.float64) if good else None, line)


class _Sheet:
    """One calibration file: its lines by name."""

    def __init__(self, name: str, lines: Mapping[str, _Line]) -> None:
        self.name, self.lines = name, lines

    def wrong(self, key: str, found: str) -> InputError:
        line = self.lines[key].line if key in self.lines else 0
        return InputError(Problem("VI306", found, Where(self.name, line, 1, key), fault="input"))

    def matrix(self, key: str, count: int) -> Array:
        if key not in self.lines:
            raise self.wrong(key, "is missing")
        numbers = self.lines[key].numbers
        if numbers is None or len(numbers) != count or not np.isfinite(numbers).all():
            raise self.wrong(key, f"wants {count} numbers")
        return numbers

    def part(self, what: str, camera: int) -> Array:
        return self.matrix(f"{what}_0{camera}", _COUNTS[what])

    def sizes(self, pair: tuple[int, int]) -> tuple[tuple[int, int], tuple[int, int]]:
        """(rows, columns) as taken, and rectified."""
        found = []
        for what in ("S", "S_rect"):
            columns, rows = self.part(what, pair[0])
            if not (1 <= rows < 1 << 20 and 1 <= columns < 1 << 20 and rows % 1 == columns % 1 == 0):
                raise self.wrong(f"{what}_0{pair[0]}", "wants width and height, whole numbers above 0")
            found.append((int(rows), int(columns)))
        return found[0], found[1]

    def view(self, camera: int, projection: Array, size: tuple[int, int]) -> View:
        matrix, rotation = (self.part(what, camera).reshape(3, 3) for what in ("K", "R_rect"))
        return View(matrix, self.part("D", camera), size, rotation, projection[:, :3])
