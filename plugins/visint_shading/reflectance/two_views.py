"""Highlights by two views: brightness that does not stay with its surface."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["brighter_than_right"]


def brighter_than_right(left: Array, right: Array, disparity: Array, noise: float) -> Array:
    """Bool (H, W): clearly brighter in the left view than where ``disparity`` finds the point in the right one.

    A matte surface looks equally bright from everywhere, a highlight moves over it. By more than five standard
    deviations of noise and a tenth, after a small blur; where the match lies outside the right view, False.
    """
    import cv2

    rows, columns = left.shape
    x = np.arange(columns, dtype=np.float32)[None] - disparity
    y = np.broadcast_to(np.arange(rows, dtype=np.float32)[:, None], x.shape)
    calm = [cv2.GaussianBlur(np.nan_to_num(view), (0, 0), 1.0) for view in (left, right)]
    inside = (x >= 0) & (x <= columns - 1)
    there = cv2.remap(calm[1], np.where(inside, x, 0).astype(np.float32), y.copy(), cv2.INTER_LINEAR)
    return np.asarray(inside & (calm[0] - there > np.maximum(5 * noise, 0.1 * calm[0])))
