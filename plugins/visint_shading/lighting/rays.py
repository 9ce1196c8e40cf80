"""Directions of light at each pixel."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import pixel_grid

__all__ = ["cosines", "light_directions"]


def light_directions(light: Light, depth: Array | None, camera: Camera) -> Array:
    """Unit vectors from the surface to the light, float32 (H, W, 3).

    A point light needs positions: unknown depth is taken as the median of the known, and if nothing is known
    the surface as lying as far before the camera as the light is away from it.
    """
    from visint_shading import _kernels

    vector = np.asarray(light.vector, np.float32)
    reach = float(np.linalg.norm(vector)) or 1.0
    place = np.full(camera.size, reach, np.float32) if depth is None else _filled(depth, reach)
    found = np.empty((*place.shape, 3), np.float32)
    across, down = (grid.ravel() for grid in pixel_grid(camera))
    near = light.place == "point"
    _kernels.directions(vector, near, place, across, down, np.float32(camera.focal_length), found)
    return found


def _filled(depth: Array, otherwise: float) -> Array:
    """``depth`` with its unknown pixels at the median of the known ones."""
    known = np.isfinite(depth) & (depth > 0)
    middle = float(np.median(depth[known][::7])) if known.any() else otherwise
    return np.where(known, depth, np.float32(middle)).astype(np.float32)


def cosines(normals: Array, light: Array) -> Array:
    """n·l, float32 (H, W), NaN where a normal is."""
    from visint_shading import _kernels

    found = np.empty(normals.shape[:2], np.float32)
    _kernels.cosines(normals, light, found)
    return found
