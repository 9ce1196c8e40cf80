"""Masks, boundaries, regions and confidence from the samples of an image file: exactly, or not at all."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.io.raster import Raster
from visint.io.refusals import unfit

__all__ = ["confidence_of", "mask_of", "regions_of"]


def mask_of(raster: Raster, name: str, kind: str = "Mask") -> Array:
    """Bool (H, W): 0 is off, the one other value on.

    Raises
    ------
    InputError
        VI305 if the image is coloured or has a third value (three-valued masks and blurred ones have no
        one meaning).
    """
    grey = _grey(raster, name, kind)
    values = np.flatnonzero(np.bincount(grey.ravel(), minlength=2))
    if len(values) > 2 or (len(values) == 2 and values[0] != 0):
        found = (
            f"has {len(values)} grey values from {values[0]} to {values[-1]}; a {kind} wants 0 and one other"
        )
        raise unfit(name, found)
    return np.asarray(grey != 0)


def regions_of(raster: Raster, name: str) -> Array:
    """int32 (H, W) labels, 0 = boundary; raises InputError VI305 if the image is coloured."""
    return _grey(raster, name, "Regions").astype(np.int32)


def confidence_of(raster: Raster, name: str) -> Array:
    """float32 (H, W) in [0, 1], the samples over the largest possible; InputError VI305 if coloured."""
    return _grey(raster, name, "Confidence").astype(np.float32) / np.float32(raster.top)


def _grey(raster: Raster, name: str, kind: str) -> Array:
    grey = raster.grey
    if grey is None:
        raise unfit(name, f"is coloured; a {kind} is read from grey images")
    return grey
