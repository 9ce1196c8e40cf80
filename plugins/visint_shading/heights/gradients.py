"""Which gradients one brightness allows: an ellipse around that of the surface that faces the light.

Heights are ln Z, so the shape is exact for a pinhole and free of scale. With g = (f p, f q, −(1 + x p + y q)),
the normal before it is made a unit vector, brightness says l·g = c |g|. In the gradient less that of the
surface square to the light, (p, q) = ∇lnZ − ∇w₀, this is A p² + 2B pq + C q² + 2D p + 2E q = 1.
"""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera, Light
from visint.fields.geometry import pixel_grid
from visint_shading.lighting.rays import rays

__all__ = ["conics", "square_to_light"]

STEEPEST = 0.03
"""How far the squared cosine stays above that at which the ellipse opens: limbs, shadows of oblique light."""


def conics(cosine: Array, light: Array, camera: Camera) -> Array:
    """float64 (5, H, W): A, B, C, D, E at each pixel, from ``cosine`` (H, W) and unit vectors ``light``."""
    x, y = pixel_grid(camera)
    f = camera.focal_length
    lx, ly, lz = (light[..., k].astype(np.float64) for k in range(3))
    facing = np.minimum((lx * x + ly * y) / f + lz, -1e-3)
    size = -1 / facing
    across, down = lx * f - lz * x, ly * f - lz * y
    oblique = 1 - facing**2 / ((x * x + y * y) / f**2 + 1)
    squared = np.clip(
        np.nan_to_num(cosine).astype(np.float64) ** 2, np.minimum(oblique + STEEPEST, 0.98), 1 - 1e-6
    )
    scale = 1 / (size**2 * (1 - squared))
    first = (squared * (f * f + x * x) - across**2) * scale
    mixed = (squared * (x * y) - across * down) * scale
    second = (squared * (f * f + y * y) - down**2) * scale
    parts = np.broadcast_arrays(first, mixed, second, -across / size, -down / size)
    return np.ascontiguousarray(np.stack(parts), np.float64)


def square_to_light(light: Light, camera: Camera, distance: float) -> Array:
    """w₀, float64 (H, W): ln Z of a surface that faces the light everywhere.

    For a distant light a plane; for one at a point the sphere around it through the axis at depth ``distance``.
    NaN where a line of sight misses it.
    """
    sight = rays(camera).astype(np.float64)
    vector = np.asarray(light.vector, np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        if light.place == "distant":
            return np.asarray(-np.log(-(sight @ vector)))
        long = (sight**2).sum(axis=-1)
        along = sight @ vector
        radius = ((np.array([0, 0, distance]) - vector) ** 2).sum()
        root = np.sqrt(along**2 - long * ((vector**2).sum() - radius))
        return np.asarray(np.log((along + root) / long))
