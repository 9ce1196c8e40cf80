"""How the angle to the light depends on the slopes of disparity."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import pixel_grid

__all__ = ["Lighting", "lighting", "normals_of_slopes"]


class Lighting(NamedTuple):
    """cos(angle to the light) of a surface, and its derivatives by d_u and d_v; float32 (H, W) each."""

    cosine: Array
    by_u: Array
    by_v: Array


def _gradient(field: Array, slopes: Array, camera: Camera) -> Array:
    """(H, W, 3) g ∝ ∇(1/Z) in the camera frame: n = -g/|g|; planes are linear in it."""
    across, down = pixel_grid(camera)
    f = camera.focal_length
    du, dv = slopes[..., 0], slopes[..., 1]
    return np.stack([f * du, f * dv, field + camera.doffs - across * du - down * dv], axis=-1)


def normals_of_slopes(field: Array, slopes: Array, camera: Camera) -> Array:
    """Unit normals float32 (H, W, 3) facing the camera, of disparity (H, W) with slopes (H, W, 2) a pixel."""
    g = _gradient(field, slopes, camera)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(-g / np.linalg.norm(g, axis=-1, keepdims=True), np.float32)


def lighting(field: Array, slopes: Array, camera: Camera, light: Light) -> Lighting:
    """c = n·l and ∂c/∂d_u = -(l - c n)·(f, 0, -(u - c_x))/|g|, likewise by d_v."""
    across, down = pixel_grid(camera)
    f = camera.focal_length
    g = _gradient(field, slopes, camera)
    length = np.linalg.norm(g, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        depth = f * camera.baseline / np.maximum(field + camera.doffs, 1e-6)
        points = np.stack([depth * across / f, depth * down / f, depth], axis=-1)
        towards = np.broadcast_to(light.directions(points.astype(np.float32)), g.shape)
        n = -g / length[..., None]
        cosine = (n * towards).sum(axis=-1)
        side = towards - cosine[..., None] * n
        by_u = -(f * side[..., 0] - across * side[..., 2]) / length
        by_v = -(f * side[..., 1] - down * side[..., 2]) / length
    return Lighting(*(np.nan_to_num(part).astype(np.float32) for part in (cosine, by_u, by_v)))
