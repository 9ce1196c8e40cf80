"""Values for pixels that the two views do not agree on."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_stereo.semiglobal.consistency import backed
from visint_stereo.semiglobal.volume import Check, Levels, Penalties, path_costs

__all__ = ["evened", "filled"]

PENALTIES = Penalties(small=10, large=(12, 100), edge=10.0)
"""Jumps of what is filled: dear on an even surface, nearly free at a brightness edge."""


def filled(
    disparity: Array, trusted: Array, right: Array, levels: Levels, grades: Array, check: Check
) -> Array:
    """float32 (H, W): ``disparity`` where trusted; elsewhere what its surroundings and visibility suggest.

    The trusted values spread along eight paths as in the matching itself, but no value is taken that would
    hide from the right view what that view sees behind. NaN everywhere if nothing is trusted.

    Parameters
    ----------
    right
        The right view's disparity, int32 (H, W).
    grades
        Brightness, uint16 (H, W): filled values change where it does.
    """
    from visint_stereo.semiglobal import _kernels

    if not trusted.any():
        return np.full_like(disparity, np.nan)
    base = levels.lowest(disparity.shape)
    cost = np.empty((*disparity.shape, levels.count), dtype=np.uint8)
    _kernels.filling_costs(disparity, trusted, right, backed(right, trusted), levels.first, base, cost)
    total = path_costs(cost, levels, grades, PENALTIES, check)
    spread = np.empty_like(disparity)
    _kernels.cheapest(total.reshape(-1), cost.shape, levels.first, base, spread)
    return np.where(trusted, disparity, spread)


def evened(disparity: Array) -> Array:
    """``disparity`` by a median of 5×5. NaN stays NaN."""
    import cv2

    known = np.isfinite(disparity)
    smooth = cv2.medianBlur(np.where(known, disparity, np.float32(0)), 5)
    whole = cv2.erode(known.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0
    return np.where(whole, smooth, disparity)
