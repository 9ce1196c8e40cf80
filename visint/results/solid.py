"""What of a result can be held: its known points, and the surface through them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from visint import io
from visint.arrays import Array
from visint.fields import geometry
from visint.fields.camera import Camera
from visint.fields.evidence import known
from visint.results import pictures

if TYPE_CHECKING:
    from visint.results.result import Result

__all__ = ["faces_of", "solid"]

_MOST = 1 << 19
"""Points of the mesh at most; of larger maps every second, third, … row and column is taken."""
_STEEPEST = math.tan(math.radians(85))
"""Tangent of the slant beyond which two neighbours are taken to lie on different surfaces, …"""
_JUMP = 1.5
"""… if their disparities differ by more than so many pixels, too: far away whole steps are steep."""


def solid(result: Result) -> Iterator[tuple[str, bytes]]:
    """``points.ply`` and ``surface.glb`` of the first depth map, where a camera is known and any depth is."""
    camera = result.camera
    depth = _first(result, "Depth")
    if camera is None or depth is None or depth.shape != camera.size or not known(depth).any():
        return
    points = geometry.back_project(depth, camera)
    beside = {"normals": _first(result, "Normals"), "colors": pictures.of_reference(result)}
    fitting = {name: one for name, one in beside.items() if one is not None and one.shape == points.shape}
    yield "points.ply", io.encode_ply(points, unit=camera.unit, **fitting)
    step = math.ceil(math.sqrt(depth.size / _MOST))
    faces = faces_of(depth[::step, ::step], camera, step)
    if len(faces):
        used, corners = np.unique(faces, return_inverse=True)
        parts = {name: _clean(one[::step, ::step].reshape(-1, 3)[used]) for name, one in fitting.items()}
        at = points[::step, ::step].reshape(-1, 3)[used]
        corners = corners.reshape(-1, 3).astype(np.int32)
        yield "surface.glb", io.encode_glb(at, corners, unit=camera.unit, **parts)


def _first(result: Result, kind: str) -> Array | None:
    return next((value for name, value in result.outputs.items() if result.kinds[name] == kind), None)


def _clean(vectors: Array) -> Array:
    """Normals that are not known face the camera: a mesh has no word for unknown."""
    if vectors.dtype == np.uint8:
        return vectors
    return np.where(np.isfinite(vectors).all(axis=1, keepdims=True), vectors, np.array([0, 0, -1], np.float32))


def faces_of(depth: Array, camera: Camera, step: int = 1) -> Array:
    """int32 (M, 3): two triangles between four neighbours in ``depth`` (H, W), by index ``row · W + column``.

    Corners go round counter-clockwise as the camera sees them. Triangles are left out where a corner is
    unknown, or where two of its corners lie on different surfaces: steeper than 85° and 1.5 pixels of disparity
    apart. ``step`` is the distance of neighbours, pixels of the camera.
    """
    rows, columns = depth.shape
    index = np.arange(rows * columns, dtype=np.int32).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    faces = np.concatenate([np.stack([a, c, b], -1).reshape(-1, 3), np.stack([b, c, d], -1).reshape(-1, 3)])
    corners = depth.reshape(-1)[faces].astype(np.float64)
    near, far = corners.min(axis=1), corners.max(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        steep = far - near > _STEEPEST * near * step / camera.focal_length
        apart = camera.focal_length * camera.baseline * (1 / near - 1 / far) > _JUMP * step
        whole = np.isfinite(far - near) & (near > 0)
    return np.asarray(faces[whole & ~(steep & apart)])
