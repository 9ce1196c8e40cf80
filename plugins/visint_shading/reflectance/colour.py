"""Highlights by colour: they are whiter and brighter than their surface."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_shading.reflectance.albedo import percentile_by_region

__all__ = ["paler_than_region"]


def paler_than_region(color: Array, labels: Array) -> Array:
    """Bool (H, W): less than 0.75 of the region's usual saturation, and brighter than most of it.

    Highlights have the light's colour (Shafer 1985, doi:10.1002/col.5080100409), so on coloured surfaces their
    saturation 1 − min/max falls. Says nothing on regions that are grey (usual saturation below 0.15).
    """
    top, bottom = color.max(axis=-1), color.min(axis=-1)
    saturation = np.where(top > 0.02, 1 - bottom / np.maximum(top, 1e-6), 0).astype(np.float32)
    usual = percentile_by_region(saturation, labels, 0.5)
    bright = percentile_by_region(np.clip(top, 0, 1), labels, 0.6)
    pale = (saturation < 0.75 * usual[labels]) & (usual[labels] > 0.15)
    return np.asarray(pale & (top > bright[labels]) & (labels > 0))
