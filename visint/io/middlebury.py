"""Middlebury's ``calib.txt``: the calibration of a rectified pair.

Lines ``name=value`` in any order: ``cam0`` and ``cam1`` are 3 × 3 matrices, ``[f 0 cx; 0 f cy; 0 0 1]``,
``doffs`` the x-difference of the principal points, ``baseline`` in mm, ``vmin`` and ``vmax`` the bounds of
the disparity (Scharstein et al. 2014, DOI 10.1007/978-3-319-11752-2_3).
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from visint.errors import InputError, Problem, Where
from visint.fields.camera import Camera

__all__ = ["middlebury_camera"]

_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?\Z", re.ASCII)
_UNIT = re.compile(r"[A-Za-z]{1,20}\Z", re.ASCII)
_MATRICES = ("cam0", "cam1")
_NUMBERS = ("doffs", "baseline", "width", "height", "ndisp", "vmin", "vmax")
_POSITIVE = ("baseline", "width", "height", "ndisp")
_WHOLE = ("width", "height", "ndisp")
_MATRIX_FORM = "[f 0 cx; 0 f cy; 0 0 1]"
_SAME = 1e-3  # relative: calibrations are printed to about six digits


class _Intrinsics(NamedTuple):
    f: float
    cx: float
    cy: float


def middlebury_camera(text: str, name: str) -> Camera:
    """The camera of a rectified pair from the text of a ``calib.txt`` called ``name`` in messages.

    The unit is mm, unless a line ``unit=`` of our own says another. ``doffs`` is cam1's cx less cam0's where
    the file has none. The search range is (vmin, vmax), else (0, ndisp − 1), else None.

    Raises
    ------
    InputError
        VI306 with every wrong line and what it should say.
    """
    sheet = _Sheet(name)
    sheet.read(text)
    return sheet.camera()


class _Sheet:
    """One calibration file: what it says, on which line, and all that is wrong with it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.lines: dict[str, int] = {}
        self.numbers: dict[str, float] = {}
        self.matrices: dict[str, _Intrinsics] = {}
        self.problems: list[Problem] = []
        self.unit = "mm"

    def wrong(self, key: str, found: str, write: str = "") -> None:
        """One more problem, on the line of ``key`` if it has one."""
        where = Where(self.name, self.lines.get(key, 0), 1, key)
        self.problems.append(Problem("VI306", found, where, write=write, fault="input"))

    def read(self, text: str) -> None:
        """Every ``name=value`` line; other names than Middlebury's are left alone."""
        for line, words in enumerate(text.splitlines(), start=1):
            key, equals, value = (part.strip() for part in words.partition("="))
            if not words.strip():
                continue
            if not equals:
                self.lines[""] = line
                self.wrong("", "is no line of a Middlebury calibration; wants name=value", "baseline=193.001")
                break  # another sort of file: one line of complaint is enough
            if key in self.lines:
                self.wrong(key, f"stands twice: first on line {self.lines[key]}, again on line {line}")
            self.lines[key] = line
            self.entry(key, value)

    def entry(self, key: str, value: str) -> None:
        """Keep one value under its name."""
        if key in _MATRICES:
            self.matrix(key, value)
        elif key in _NUMBERS:
            self.number(key, value)
        elif key == "unit" and not _UNIT.match(value):
            self.wrong(key, f"is {value[:40]!r}; wants a word", "unit=mm")
        elif key == "unit":
            self.unit = value

    def number(self, key: str, value: str) -> None:
        """Keep a number; sizes and counts are whole and positive."""
        number = float(value) if _NUMBER.match(value) else math.nan
        wanted = "a whole number" if key in _WHOLE else "a number"
        positive = key in _POSITIVE
        if not math.isfinite(number) or (positive and number <= 0) or (key in _WHOLE and number % 1):
            self.wrong(key, f"is {value[:40]!r}; wants {wanted}{' above 0' if positive else ''}")
        else:
            self.numbers[key] = number

    def matrix(self, key: str, value: str) -> None:
        """Keep f, cx and cy of an intrinsic matrix with square pixels and no skew."""
        words = value.removeprefix("[").removesuffix("]").replace(";", " ").split()
        rows = [len(row.split()) for row in value.strip("[]").split(";")]
        if rows != [3, 3, 3] or not all(_NUMBER.match(word) for word in words):
            self.wrong(
                key,
                f"wants a 3 × 3 matrix {_MATRIX_FORM}",
                f"{key}=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]",
            )
            return
        fx, skew, cx, zero, fy, cy, *last = (float(word) for word in words)
        if not (fx > 0 and math.isclose(fx, fy, rel_tol=_SAME)):
            self.wrong(
                key, f"has focal lengths {fx:g} and {fy:g}; wants square pixels: both the same and above 0"
            )
        elif skew != 0 or zero != 0 or last != [0, 0, 1]:
            self.wrong(key, f"wants the form {_MATRIX_FORM}, without skew")
        else:
            self.matrices[key] = _Intrinsics(fx, cx, cy)

    def camera(self) -> Camera:
        """The camera, once nothing is wrong."""
        self.complete()
        self.rectified()
        span = self.search_range()
        if self.problems:
            raise InputError(self.problems)
        left, numbers = self.matrices["cam0"], self.numbers
        return Camera(
            focal_length=left.f, cx=left.cx, cy=left.cy, baseline=numbers["baseline"],
            width=int(numbers["width"]), height=int(numbers["height"]),
            doffs=self.doffs(), disparity_range=span, unit=self.unit,
        )  # fmt: skip

    def complete(self) -> None:
        """Complain of each name that must be there and is not."""
        for key in ("cam0", "baseline", "width", "height"):
            if key not in self.lines:
                self.wrong(key, "is missing", f"{key}={_MATRIX_FORM if key == 'cam0' else '…'}")
        if "doffs" not in self.lines and "cam1" not in self.lines:
            self.wrong("doffs", "is missing, and so is cam1, from which it would follow", "doffs=0")

    def rectified(self) -> None:
        """Complain of two matrices that no rectified pair has."""
        if len(self.matrices) < 2:
            return
        left, right = (self.matrices[key] for key in _MATRICES)
        if not math.isclose(left.f, right.f, rel_tol=_SAME) or abs(left.cy - right.cy) > 0.5:
            self.wrong("cam1", "has another focal length or cy than cam0; wants a rectified pair")
        elif "doffs" in self.numbers and abs(right.cx - left.cx - self.numbers["doffs"]) > 0.5:
            found = f"is {self.numbers['doffs']:g}, but cam1's cx less cam0's is {right.cx - left.cx:g}"
            self.wrong("doffs", found, f"doffs={right.cx - left.cx:g}")

    def doffs(self) -> float:
        """x-difference of the principal points, pixels."""
        if "doffs" in self.numbers:
            return self.numbers["doffs"]
        return self.matrices["cam1"].cx - self.matrices["cam0"].cx

    def search_range(self) -> tuple[float, float] | None:
        """The bounds of the disparity, pixels."""
        numbers = self.numbers
        if "vmin" in numbers and "vmax" in numbers:
            if numbers["vmin"] >= numbers["vmax"]:
                self.wrong(
                    "vmin", f"is {numbers['vmin']:g} and vmax {numbers['vmax']:g}; wants vmin below vmax"
                )
            return numbers["vmin"], numbers["vmax"]
        return (0.0, numbers["ndisp"] - 1) if numbers.get("ndisp", 0) > 1 else None
