"""A rig or a rectified pair from the names that OpenCV's users give its parts."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from visint.arrays import Array
from visint.errors import InputError, Problem, Where
from visint.fields.camera import Camera
from visint.io.opencv_yaml import Entry, opencv_entries
from visint.io.rectification import Rig, View, pair_camera

__all__ = ["opencv_calibration"]

_NAMES = {
    "M1": ("m1", "k1", "cameramatrix1", "cameramatrixl", "cameramatrixleft", "leftcameramatrix", "kleft", "kl"),
    "M2": ("m2", "k2", "cameramatrix2", "cameramatrixr", "cameramatrixright", "rightcameramatrix", "kright",
           "kr"),
    "D1": ("d1", "distcoeffs1", "distortioncoefficients1", "distcoeffsl", "distcoeffsleft", "dleft", "dl"),
    "D2": ("d2", "distcoeffs2", "distortioncoefficients2", "distcoeffsr", "distcoeffsright", "dright", "dr"),
    "R": ("r", "rotation", "rotationmatrix"),
    "T": ("t", "translation", "translationvector"),
    "P1": ("p1", "pl", "pleft"),
    "P2": ("p2", "pr", "pright"),
    "width": ("imagewidth", "width"),
    "height": ("imageheight", "height"),
    "size": ("imagesize", "size", "imsize"),
    "unit": ("unit", "units"),
}  # fmt: skip
_KNOWN = {spelled: key for key, names in _NAMES.items() for spelled in names}
_MISSING = "is missing; a rig has M1, D1, M2, D2, R and T"
_SHAPES = {"M1": (3, 3), "M2": (3, 3), "R": (3, 3), "P1": (3, 4), "P2": (3, 4)}
_COEFFICIENTS = (4, 5, 8, 12, 14)
_SAYS_RECTIFIED = (
    "the calibration is of a pair that is not rectified, and both images were rectified by it; all maps are of "
    "the rectified left image. If the images were rectified already, give a calibration of P1 and P2 alone"
)


def opencv_calibration(
    text: str, name: str, size: tuple[int, int] | None
) -> tuple[Camera, tuple[View, View] | None, tuple[str, ...]]:
    """Camera, views and remarks from the text of an OpenCV YAML file; ``size`` if it does not say its own.

    Raises
    ------
    InputError
        VI306, all that is wrong together.
    """
    sheet = _Sheet(name, opencv_entries(text, name))
    found = sheet.size() or size
    if found is None:
        sheet.wrong("image_width", "and image_height are missing, and there are no images to ask",
                    "image_width: 1280")  # fmt: skip
    unit = sheet.unit()
    if not any(key in sheet.entries for key in ("M1", "M2", "R", "T")):
        return sheet.pair(found, unit), None, ()
    rig = sheet.rig(found or (1, 1), unit)
    camera, views = rig.rectification()
    return camera, views, (_SAYS_RECTIFIED,) if views else ()


class _Sheet:
    """The entries of one file by our names, and all that is wrong with them."""

    def __init__(self, name: str, entries: Mapping[str, Entry]) -> None:
        self.name = name
        self.entries: dict[str, tuple[str, Entry]] = {}
        self.problems: list[Problem] = []
        for spelled, entry in entries.items():
            key = _KNOWN.get(re.sub(r"[\W_]", "", spelled.lower()))
            if key in self.entries:
                self.wrong(key, f"stands twice, as {self.entries[key][0][:40]} and as {spelled[:40]}")
            elif key is not None:
                self.entries[key] = (spelled, entry)

    def wrong(self, key: str, found: str, write: str = "") -> None:
        spelled, entry = self.entries.get(key, (key, Entry(None, 0)))
        where = Where(self.name, entry.line, 1, spelled)
        self.problems.append(Problem("VI306", found, where, write=write, fault="input"))

    def settle(self) -> None:
        if self.problems:
            raise InputError(self.problems)

    def value(self, key: str) -> Any:
        return self.entries[key][1].value if key in self.entries else None

    def numbers(self, key: str) -> Array | None:
        """float64 of any shape, from a matrix, a number, or lists of them."""
        value = self.value(key)
        try:
            found = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            return None
        return found if value is not None and np.isfinite(found).all() else None

    def matrix(self, key: str) -> Array:
        found = self.numbers(key)
        shape = _SHAPES[key]
        if key not in self.entries:
            self.wrong(key, _MISSING, f"{key}: !!opencv-matrix …")
        elif found is None or found.shape != shape:
            self.wrong(key, f"wants a matrix of {shape[0]} × {shape[1]} numbers")
        else:
            return found
        return np.eye(*shape)

    def intrinsics(self, key: str) -> Array:
        found = self.matrix(key)
        straight = found[1, 0] == 0 and found[0, 1] == 0 and found[2].tolist() == [0, 0, 1]
        if not straight or found[0, 0] <= 0 or found[1, 1] <= 0:
            self.wrong(key, "wants the form [f_x 0 c_x; 0 f_y c_y; 0 0 1], focal lengths above 0")
        return found

    def distortion(self, key: str) -> Array:
        found = self.numbers(key) if key in self.entries else np.zeros(5)
        if found is None or found.size not in _COEFFICIENTS:
            self.wrong(key, "wants 4, 5, 8, 12 or 14 coefficients: k1 k2 p1 p2 [k3 …]")
            return np.zeros(5)
        return np.asarray(found.reshape(-1))

    def rotation(self) -> Array:
        found = self.matrix("R")
        if np.abs(found @ found.T - np.eye(3)).max() > 1e-3 or np.linalg.det(found) < 0:
            self.wrong("R", "is no rotation: its columns are not of length 1 and at right angles")
        return found

    def translation(self) -> Array:
        found = self.numbers("T")
        if found is None or found.size != 3 or not found.any():
            wanted = "wants three numbers: where the left camera lies, seen from the right one"
            self.wrong("T", wanted if "T" in self.entries else _MISSING)
            return np.array([-1.0, 0, 0])
        return np.asarray(found.reshape(3))

    def size(self) -> tuple[int, int] | None:
        """(rows, columns), if the file says so."""
        pair = self.numbers("size") if "size" in self.entries else np.array([])
        if pair is not None and pair.size == 0 and {"width", "height"} <= set(self.entries):
            width, height = self.numbers("width"), self.numbers("height")
            pair = np.array([width, height]) if width is not None and height is not None else None
        if pair is not None and pair.size == 0:
            return None
        if pair is None or pair.size != 2 or (pair < 1).any() or (pair > 1 << 20).any() or (pair % 1).any():
            self.wrong(
                "size" if "size" in self.entries else "width", "wants whole numbers above 0: width, height"
            )
            return (1, 1)
        columns, rows = pair.reshape(-1)
        return int(rows), int(columns)

    def unit(self) -> str:
        unit = self.value("unit")
        if unit is not None and unit not in ("mm", "cm", "m"):
            self.wrong("unit", f"is {str(unit)[:20]!r}", "unit: mm   (or cm, or m: that of T)")
        return str(unit or "units of T")

    def pair(self, size: tuple[int, int] | None, unit: str) -> Camera:
        left, right = self.matrix("P1"), self.matrix("P2")
        self.settle()
        level = np.abs(left[1, :3] - right[1, :3]).max() < 0.5 and abs(left[0, 0] / right[0, 0] - 1) < 1e-3
        camera = pair_camera(left, right, size or (1, 1), unit) if right[0, 0] and level else None
        if camera is None:
            self.wrong("P2", "wants P1's focal length and cy, and −f · baseline in its last column")
        self.settle()
        assert camera is not None
        return camera

    def rig(self, size: tuple[int, int], unit: str) -> Rig:
        rig = Rig(
            self.name, (self.intrinsics("M1"), self.intrinsics("M2")),
            (self.distortion("D1"), self.distortion("D2")),
            self.rotation(), self.translation(), size, unit,
        )  # fmt: skip
        self.settle()
        return rig
