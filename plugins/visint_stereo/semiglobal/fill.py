"""Values for pixels that the two views do not agree on."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["evened", "from_behind"]


def from_behind(disparity: Array, trusted: Array) -> Array:
    """float32 (H, W): ``disparity`` where trusted, else the smaller of the two nearest trusted in the row.

    What one view alone sees lies behind its neighbour. NaN in rows that trust nothing.
    """
    columns = disparity.shape[1]
    here = np.arange(columns)
    before = np.maximum.accumulate(np.where(trusted, here, -1), axis=1)
    after = np.minimum.accumulate(np.where(trusted, here, columns)[:, ::-1], axis=1)[:, ::-1]
    padded = np.pad(disparity.astype(np.float32), ((0, 0), (1, 1)), constant_values=np.inf)
    nearest = [np.take_along_axis(padded, where + 1, axis=1) for where in (before, after)]
    smaller = np.minimum(*nearest)
    return np.where(trusted, disparity, np.where(np.isfinite(smaller), smaller, np.nan)).astype(np.float32)


def evened(disparity: Array) -> Array:
    """``disparity`` by a median of 5×5: rows filled one by one no longer fray. NaN stays NaN."""
    import cv2

    known = np.isfinite(disparity)
    smooth = cv2.medianBlur(np.where(known, disparity, np.float32(0)), 5)
    whole = cv2.erode(known.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    return np.where(whole, smooth, disparity)
