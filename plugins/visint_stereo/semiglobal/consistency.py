"""Which disparities both views agree on, and which pixels the right view cannot see."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["agreed", "backed", "occluded", "without_speckles"]


def _across(disparity: Array) -> tuple[Array, Array]:
    """(column of the right pixel that each pixel matches, clipped; whether it lies inside the image)."""
    columns = disparity.shape[1]
    column = np.arange(columns, dtype=np.int32) - np.rint(disparity).astype(np.int32)
    return np.clip(column, 0, columns - 1), (column >= 0) & (column < columns)


def agreed(disparity: Array, right: Array, tolerance: float) -> Array:
    """Bool (H, W): whether the matched right pixel points back to within ``tolerance`` px."""
    column, inside = _across(disparity)
    back = np.take_along_axis(right, column, axis=1)
    return np.asarray(inside & (np.abs(disparity - back) <= tolerance))


def backed(right: Array, trusted: Array) -> Array:
    """Bool (H, W): right pixels whose own match in the left view is trusted; right: int32 (H, W), px."""
    columns = right.shape[1]
    column = np.arange(columns, dtype=np.int32) + right
    inside = (column >= 0) & (column < columns)
    found = np.take_along_axis(trusted, np.clip(column, 0, columns - 1), axis=1)
    return np.asarray(inside & found)


def occluded(disparity: Array, right: Array, trusted: Array) -> Array:
    """Bool (H, W): pixels that do not agree and whose right pixel belongs to something nearer."""
    column, inside = _across(disparity)
    back = np.take_along_axis(right, column, axis=1)
    return np.asarray(~trusted & (~inside | (back > disparity + 1)))


def without_speckles(disparity: Array, trusted: Array, size: int) -> Array:
    """``trusted`` without islands of at most ``size`` px, connected by steps of at most 1 px.

    Wrong islands survive the check between the views, since both read the same volume.
    """
    import cv2

    none = -32768
    sixteenths = np.clip(np.rint(disparity * 16), none + 1, 32767)
    islands = np.where(trusted, sixteenths, none).astype(np.int16)
    cv2.filterSpeckles(islands, none, size, 16)
    return np.asarray(islands != none)
