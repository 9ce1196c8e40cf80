"""How sure the map is, as a variance: one scale for cues, for the map, and for whoever reads the result."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.fields import Camera

__all__ = ["confidence_of", "depth_per_pixel", "disparity_of", "variance_of"]


def variance_of(confidence: Array) -> Array:
    """Variance of the disparity, **full-size** px², that a confidence in [0, 1] stands for: 1/c − 1.

    So ½ is a standard deviation of one pixel, 0.99 of a tenth, 0 knows nothing (infinite).
    """
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.clip(confidence, 0, 1) - 1, dtype=np.float32)


def confidence_of(variance: Array) -> Array:
    """The reverse: 1/(1 + v), 0 where the variance is infinite or unknown."""
    return np.nan_to_num(1 / (1 + np.maximum(variance, 0)), nan=0.0).astype(np.float32, copy=False)


def disparity_of(depth: Array, camera: Camera) -> Array:
    """Disparity, px of the level, float32; NaN where depth is unknown or not positive."""
    strength = np.float32(camera.focal_length * camera.baseline)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(depth > 0, strength / depth - np.float32(camera.doffs), np.float32(np.nan))


def depth_per_pixel(depth: Array, camera: Camera) -> Array:
    """How much depth one pixel of disparity is worth at ``depth``: Z²/(f B), float32 (H, W)."""
    return np.asarray(depth * depth / np.float32(camera.focal_length * camera.baseline), dtype=np.float32)
