"""Images: linear intensity in [0, 1] from the samples of an image file or a float map."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.io.curves import linear_samples, luminance, powered
from visint.io.raster import Raster

__all__ = ["color_of", "image_of", "intensity"]


def image_of(raster: Raster, gamma: float | None) -> Array:
    """float32 (H, W) linear intensity of a raster; colour by luminance, grey in three channels exactly."""
    grey = raster.grey
    if grey is not None:
        return linear_samples(grey, raster.top, gamma)
    return luminance(linear_samples(raster.samples, raster.top, gamma))


def color_of(raster: Raster, gamma: float | None) -> Array:
    """float32 (H, W, 3) linear RGB of a raster; grey in three equal channels."""
    return _three(linear_samples(raster.samples, raster.top, gamma))


def intensity(value: Array, channels: int, gamma: float | None) -> Array:
    """A float map, (H, W) or (H, W, 3) in [0, 1], with as many ``channels`` as wanted: 1 or 3.

    Any other shape comes back as it is, for the field's spec to refuse.
    """
    if value.ndim == 3 and value.shape[2] == 3 and channels == 1:
        return luminance(powered(value, gamma))
    return powered(_three(value) if channels == 3 else value, gamma)


def _three(value: Array) -> Array:
    return np.repeat(value[..., None], 3, axis=2) if value.ndim == 2 else value
