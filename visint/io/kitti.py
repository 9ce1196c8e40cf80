"""KITTI's disparity PNG: 16 bits, disparity × 256, 0 = unknown (the stereo 2015 development kit)."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint.io.png import encode_png
from visint.io.raster import Raster
from visint.io.refusals import inexact, unfit

__all__ = ["encode_kitti", "fits_kitti", "kitti_disparity"]

_STEPS = 256
_MOST = 65535 / _STEPS


def kitti_disparity(raster: Raster, name: str) -> Array:
    """float32 (H, W) disparity in pixels, unknown NaN.

    Raises
    ------
    InputError
        VI305 if the image is not 16-bit grey: the factor of an 8-bit disparity map stands in no file.
    """
    if raster.samples.dtype != np.uint16 or raster.samples.ndim != 2 or raster.top != 65535:
        depth = "16-bit colour" if raster.samples.dtype == np.uint16 else "8-bit"
        found = (
            f"is an {depth} image; a Disparity wants 16-bit grey PNG (disparity × 256, 0 unknown), PFM or npy"
        )
        write = 'numpy.save("disparity.npy", (samples / factor).astype("float32"))'
        raise unfit(name, found.replace("an 16", "a 16"), write=write)
    disparity = raster.samples.astype(np.float32) / np.float32(_STEPS)
    disparity[raster.samples == 0] = np.nan
    return disparity


def fits_kitti(disparity: Array) -> bool:
    """Whether every known disparity (H, W) can be held: 0 to 255.996 pixels."""
    known = disparity[np.isfinite(disparity)]
    return known.size == 0 or bool(known.min() >= 0 and known.max() <= _MOST)


def encode_kitti(disparity: Array) -> bytes:
    """A 16-bit PNG of ``disparity``, rounded to 1/256 pixel; unknown is 0, so a known 0 becomes 1/256.

    Parameters
    ----------
    disparity
        float32 (H, W), pixels, within 0 … 255.996 where known. See :func:`fits_kitti`.

    Raises
    ------
    OutputError
        VI603 for another array, or one with disparities outside that range (converging cameras have them).
    """
    if disparity.dtype != np.float32 or disparity.ndim != 2:
        raise inexact(
            f"a KITTI PNG holds float32 (H, W) disparity; this is {disparity.dtype} {disparity.shape}"
        )
    if not fits_kitti(disparity):
        raise inexact("some disparities lie outside 0 … 255.996 px, all that a KITTI PNG holds; PFM holds them")
    known = np.isfinite(disparity)
    steps = np.maximum(np.rint(np.where(known, disparity, 0) * _STEPS), 1)
    return encode_png(np.where(known, steps, 0).astype(np.uint16))
