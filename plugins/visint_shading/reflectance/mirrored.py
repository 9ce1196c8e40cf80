"""The light mirrored at the surface, as seen along the line of sight."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera
from visint.fields.geometry import pixel_grid
from visint_shading.lighting.rays import cosines

__all__ = ["mirrored"]


def mirrored(normals: Array, light: Array, camera: Camera) -> Array:
    """r·v, float32 (H, W): cosine between the mirrored light r = 2(n·l)n − l and the way to the camera."""
    across, down = pixel_grid(camera)
    f = np.float32(camera.focal_length)
    x, y = np.broadcast_arrays(-across / f, -down / f)
    length = np.sqrt(x * x + y * y + 1)
    view = np.ascontiguousarray(np.stack([x, y, -np.ones_like(x)], axis=-1) / length[..., None], np.float32)
    return 2 * cosines(normals, light) * cosines(normals, view) - cosines(light, view)
