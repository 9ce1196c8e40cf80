"""Lines of sight and directions of light at each pixel."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import back_project, pixel_grid

__all__ = ["filled", "light_directions", "rays"]


def rays(camera: Camera) -> Array:
    """float32 (H, W, 3): the line of sight through each pixel, with depth 1."""
    across, down = pixel_grid(camera)
    f = np.float32(camera.focal_length)
    x, y = np.broadcast_arrays(across / f, down / f)
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def light_directions(light: Light, depth: Array | None, camera: Camera) -> Array:
    """Unit vectors from the surface to the light: float32 (3,) if it is distant, (H, W, 3) at a point.

    A point light needs positions: unknown depth is taken as the median of the known, and if nothing is known
    the surface as lying as far before the camera as the light is away from it.
    """
    if light.place == "distant":
        return light.directions(np.zeros(3))
    reach = float(np.linalg.norm(np.asarray(light.vector))) or 1.0
    place = np.full(camera.size, reach, np.float32) if depth is None else filled(depth, reach)
    return light.directions(back_project(place, camera))


def filled(depth: Array, otherwise: float) -> Array:
    """``depth`` with its unknown pixels at the median of the known ones."""
    known = np.isfinite(depth) & (depth > 0)
    middle = float(np.median(depth[known][::7])) if known.any() else otherwise
    return np.where(known, depth, np.float32(middle)).astype(np.float32)
