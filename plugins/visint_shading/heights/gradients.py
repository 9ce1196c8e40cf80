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

__all__ = ["conics", "square_to_light"]

STEEPEST = 0.03
"""How far the squared cosine stays above that at which the ellipse opens: limbs, shadows of oblique light."""


def conics(cosine: Array, light: Array, camera: Camera) -> Array:
    """A to E and the steps they allow, float64 (H, W, 11), from ``cosine`` (H, W) and ``light`` (H, W, 3)."""
    from visint_shading.heights import _kernels

    across, down = pixel_grid(camera)
    found = np.empty((*cosine.shape, 11))
    _kernels.conics(cosine, light, across.ravel(), down.ravel(), camera.focal_length, STEEPEST, found)
    return found


def square_to_light(light: Light, camera: Camera, distance: float) -> Array:
    """w₀, float64 (H, W): ln Z of a surface that faces the light everywhere.

    For a distant light a plane; for one at a point the sphere around it through the axis at depth ``distance``.
    NaN where a line of sight misses it.
    """
    x, y = (grid.astype(np.float64) / camera.focal_length for grid in pixel_grid(camera))
    lx, ly, lz = np.asarray(light.vector, np.float64)
    along = lx * x + ly * y + lz
    with np.errstate(invalid="ignore", divide="ignore"):
        if light.place == "distant":
            return np.asarray(-np.log(-along))
        long = x * x + y * y + 1
        surplus = (distance - lz) ** 2 - lz * lz  # of the sphere's squared radius over the light's own distance
        return np.asarray(np.log((along + np.sqrt(along**2 + long * surplus)) / long))
