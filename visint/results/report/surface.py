"""The section with the surface in three dimensions: its grid as data, which the script draws."""

from __future__ import annotations

import base64
import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields.evidence import known
from visint.results.pictures import reference
from visint.results.report.markup import Markup, element
from visint.results.report.numbers import percent
from visint.results.report.setting import Setting

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["Grid", "surface"]

_MOST, _PER_SIDE = 320, 4
"""Columns or rows of the grid at most, and pixels of the pictures a column of it: it shrinks with them."""

_LEVELS = 65534
"""Steps of a height: 16 bits, less the 0 that stands for unknown."""

_FAR = 0.25
"""How far outside the 1st to 99th percentile a height is still drawn, in parts of that range."""

_TEAR = {"perspective": 0.05, "parallel": 0.15}
"""Neighbours are not joined where nearness differs by more than this share of itself; height, of its range."""


class Grid(NamedTuple):
    """Heights to be drawn: values at every ``step``-th pixel, and how they become points.

    ``heights`` is uint16 (rows, columns); 0 is unknown, else ``low + (high − low) · (h − 1) / 65533``. Under
    ``perspective`` that is 1/Z, from a camera of focal length ``f`` and centre (cx, cy); under ``parallel``
    it is depth in pixels.
    """

    heights: Array
    low: float
    high: float
    step: int
    model: str
    f: float
    cx: float
    cy: float

    def told(self) -> dict[str, Any]:
        """All but the heights, for the script."""
        rows, columns = self.heights.shape
        told = {"rows": rows, "columns": columns, "tear": _TEAR[self.model]}
        return told | {name: value for name, value in self._asdict().items() if name != "heights"}


def surface(setting: Setting) -> Markup | None:
    """The first depth map, or relief, as a surface to be turned."""
    found = _first(setting.result)
    if found is None:
        return None
    name, kind, value = found
    grid = _grid(setting.result, kind, value, min(_MOST, max(8, setting.side // _PER_SIDE)))
    if grid is None:
        return None
    seen = reference(setting.result)
    size = np.array(value.shape)
    says = f"The surface of {name} in three dimensions, {percent(_share(grid.heights > 0))} of it known"
    return element(
        "div",
        element("p", "The surface is drawn by a browser with scripts and WebGL.", class_="instead"),
        class_="surface",
        data_grid=json.dumps(grid.told() | {"height": int(size[0]), "width": int(size[1])}),
        data_heights=base64.b64encode(grid.heights.astype("<u2").tobytes()).decode(),
        data_view="yes" if seen is not None and seen[1].shape[:2] == value.shape else None,
        data_says=says,
        data_note=_note(setting.result, kind),
    )


def _first(result: Result) -> tuple[str, str, Array] | None:
    for wanted in ("Depth", "Relief"):
        for name, value in result.outputs.items():
            if result.kinds[name] == wanted and isinstance(value, np.ndarray) and min(value.shape) > 1:
                return name, wanted, value
    return None


def _note(result: Result, kind: str) -> str:
    if kind == "Relief":
        return "A relief is known up to scale and tilt: its height here is a quarter of its width."
    if result.camera is None or not result.camera.calibrated:
        return "Without a calibration the shape is known up to a stretch along the line of sight."
    return "What depth leaps over is left open: the surface is torn there, as it is hidden from the camera."


def _share(where: Array) -> float:
    return float(np.count_nonzero(where)) / where.size


def _grid(result: Result, kind: str, value: Array, most: int) -> Grid | None:
    step = max(1, -(-max(value.shape) // most))
    sampled = value[::step, ::step].astype(np.float64)
    model = "perspective" if kind == "Depth" else "parallel"
    if model == "perspective":
        with np.errstate(divide="ignore", invalid="ignore"):
            sampled = np.where(sampled > 0, 1 / sampled, np.nan)
    if min(sampled.shape) < 2 or not known(sampled).any():
        return None
    low, high = _range(sampled, above_zero=model == "perspective")
    with np.errstate(invalid="ignore"):
        drawn = (sampled >= low) & (sampled <= high)
    heights = np.where(drawn, 1 + np.round((sampled - low) / (high - low) * (_LEVELS - 1)), 0)
    if model == "parallel":
        low, high = 0.0, 0.25 * value.shape[1]
    return Grid(np.nan_to_num(heights).astype(np.uint16), low, high, step, model, *_rays(result, value))


def _range(sampled: Array, *, above_zero: bool) -> tuple[float, float]:
    """What is drawn: most of the known and a little more, lest a few wild points make all else small."""
    low, high = (float(q) for q in np.nanpercentile(sampled, (1, 99)))
    margin = _FAR * (high - low) or 0.01 * (abs(low) or 1.0)
    lowest = max(low - margin, low / 4) if above_zero else low - margin
    return lowest, high + margin


def _rays(result: Result, value: Array) -> tuple[float, float, float]:
    """Focal length and centre of the camera of these maps; without one, a view about 53° wide."""
    camera = result.camera
    if camera is not None and camera.size == value.shape:
        return camera.focal_length, camera.cx, camera.cy
    rows, columns = value.shape
    return float(columns), (columns - 1) / 2, (rows - 1) / 2
