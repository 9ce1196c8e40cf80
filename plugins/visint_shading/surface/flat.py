"""Regions of one brightness: one plane each."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint_shading.surface.orientation import Orientation

__all__ = ["flat_regions", "with_planes"]

CONTRAST = 0.05


def flat_regions(even: Array, labels: Array) -> Array:
    """Bool (N + 1,): brightness hardly changes over the region, so that it turns nowhere."""
    count = int(labels.max(initial=0)) + 1
    inside = np.flatnonzero(labels)
    label, value = labels.ravel()[inside], even.ravel()[inside].astype(np.float64)
    members = np.maximum(np.bincount(label, minlength=count), 1)
    mean = np.bincount(label, value, minlength=count) / members
    square = np.bincount(label, value * value, minlength=count) / members
    found = np.sqrt(np.maximum(square - mean**2, 0)) < CONTRAST * mean
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
