"""Regions of one brightness: one plane each."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint_shading.reflectance.albedo import percentiles_by_region
from visint_shading.surface.orientation import Orientation

__all__ = ["flat_regions", "with_planes"]

CONTRAST = 0.06
"""A near light and a wide face make so much of a difference on a plane."""


def flat_regions(even: Array, labels: Array, spread: float) -> Array:
    """Bool (N + 1,): brightness hardly changes over the region, so that it turns nowhere.

    Four fifths of the pixels lie within 6 % and 2.5 standard deviations of the noise left in ``even``.
    """
    value = np.clip(np.nan_to_num(even), 0, 1)
    low, middle, high = percentiles_by_region(value, labels, 0.1, 0.5, 0.9)
    found = high - low < CONTRAST * middle + 2.5 * spread
    found[0] = False
    return np.asarray(found)


def with_planes(surface: Orientation, depth: Array, labels: Array, flat: Array, camera: Camera) -> Orientation:
    """``surface`` with one normal in each ``flat`` region, that of the plane fitted to the map's depth.

    Over a wide plane that is far better than any window. 1/Z is linear over the image of a plane, and
    n ∝ −(f a, f b, w − x a − y b) with a, b its slopes and w its value.
    """
    from visint_shading import _kernels

    if not flat.any():
        return surface
    with np.errstate(divide="ignore", invalid="ignore"):
        nearness = np.where(depth > 0, 1 / depth, np.nan).astype(np.float32)
    found = np.zeros((flat.size, 4))
    _kernels.planes(nearness, labels, flat, 0.02, 5, np.zeros((flat.size, 10)), found)
    width, (rows, columns) = camera.width, depth.shape
    a, b = found[:, 0] / width, found[:, 1] / width
    middle = found[:, 2] + a * (camera.cx - columns / 2) + b * (camera.cy - rows / 2)
    normal = -np.column_stack([camera.focal_length * a, camera.focal_length * b, middle])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    use = (found[:, 3] > 0) & flat & (normal[:, 2] < 0)
    there = use[labels]
    normals = np.where(there[..., None], normal.astype(np.float32)[labels], surface.normals)
    return Orientation(normals, np.where(there, 1, surface.weight).astype(np.float32))
