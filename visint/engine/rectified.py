"""A camera from its calibration; the images of a rig that is not rectified are warped with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from visint import io
from visint.errors import InputError
from visint.fields.camera import Camera
from visint.graph.graph import Graph

__all__ = ["calibrated"]

_IMAGES = ("Image", "Color")


def calibrated(graph: Graph, path: str | Path, values: dict[str, Any], note: Callable[[str], None]) -> Camera:
    """The camera in ``path``; ``values``, the inputs read so far, are rectified in place if they must be.

    The pair is the inputs ``left`` and ``right``; a graph with one image alone sees by the left camera.

    Raises
    ------
    InputError
        VI306 if the calibration is wrong, VI307 if it does not fit the images, or if there are inputs of the
        images' size that cannot be warped with them.
    """
    sizes = [value.shape[:2] for value in values.values() if hasattr(value, "shape") and value.ndim > 1]
    calibration = io.read_calibration(path, sizes[0] if sizes else None)
    for remark in calibration.remarks:
        note(remark)
    if calibration.views is not None:
        for name, side in _sides(graph, values):
            values[name] = calibration.rectify(values[name], side)
    return calibration.camera


def _sides(graph: Graph, values: dict[str, Any]) -> Iterator[tuple[str, int]]:
    """Which input is the left image, and which the right one."""
    images = [name for name in values if graph.inputs[name].kind in _IMAGES and not graph.inputs[name].many]
    sides = {"left": 0, "right": 1} if "left" in images else dict.fromkeys(images[:1], 0)
    for name, value in values.items():
        if name in sides:
            yield name, sides[name]
        elif isinstance(value, tuple) or (hasattr(value, "shape") and value.ndim > 1):
            found = (
                f"the calibration is of a pair that is not rectified, and {name!r} cannot be rectified with it"
            )
            raise InputError.of("VI307", found, write="(all images rectified, and a calibration of P1 and P2)")
