"""Directions of light at each pixel."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import pixel_grid

__all__ = ["cosines", "light_directions", "usual_depth"]


def light_directions(light: Light, depth: Array | None, camera: Camera, usual: float) -> Array:
    """Unit vectors from the surface to the light, float32 (H, W, 3).

    A point light needs positions: unknown depth is taken as ``usual``.
    """
    from visint_shading import _kernels

    vector = np.asarray(light.vector, np.float32)
    with np.errstate(invalid="ignore"):
        place = np.full(camera.size, np.float32(usual))
        if depth is not None:
            place = np.where(depth > 0, depth, np.float32(usual))
    found = np.empty((*place.shape, 3), np.float32)
    across, down = (grid.ravel() for grid in pixel_grid(camera))
    near = light.place == "point"
    _kernels.directions(vector, near, place, across, down, np.float32(camera.focal_length), found)
    return found


def usual_depth(depth: Array | None, light: Light, camera: Camera) -> float:
    """The median of the known depth; else what the middle of the search range stands for; else ten baselines,
    or as far as the light is away if that is more.
    """
    if depth is not None:
        known = np.flatnonzero((depth > 0) & (depth < np.inf))
        if known.size:
            return float(np.median(depth.ravel()[known[::7]]))
    shift = (camera.middle_disparity or 0.0) + camera.doffs
    if shift > 0:
        return camera.focal_length * camera.baseline / shift
    return max(10 * camera.baseline, float(np.linalg.norm(np.asarray(light.vector))))


def cosines(normals: Array, light: Array) -> Array:
    """n·l, float32 (H, W), NaN where a normal is."""
    from visint_shading import _kernels

    found = np.empty(normals.shape[:2], np.float32)
    _kernels.cosines(normals, light, found)
    return found
