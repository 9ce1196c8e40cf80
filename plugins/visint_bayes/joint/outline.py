"""A first surface from two outlines, for when the matcher has lost its way."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["outlined", "unmatched"]

LOST = 0.15
"""A surface that leaves more of the right view's foreground without a match has folded, and is no start."""
ROWS = 9
"""Rows over which the shift of the outline is evened."""


def unmatched(field: Array, inside: Array, inside_right: Array) -> float:
    """Part of the right view's foreground that no pixel of the left one's reaches at ``field`` (H, W)."""
    from visint_bayes.joint.matching import _kernels

    there = np.empty_like(field)
    _kernels.nearest_there(field, inside, there)
    return float(np.isnan(there[inside_right]).mean()) if inside_right.any() else 1.0


def outlined(inside: Array, inside_right: Array) -> Array:
    """float32 (H, W) disparity: on each row the shifts of the outline's two ends, linear in between.

    The ends of a round outline are different points of the thing, so this is right to some pixels, not more;
    rows that only one view fills take the nearest others'.
    """
    from scipy.ndimage import median_filter

    rows = np.nonzero(inside.any(axis=1) & inside_right.any(axis=1))[0]
    if not rows.size:
        return np.zeros(inside.shape, np.float32)
    ends = [_ends(mask[rows]) for mask in (inside, inside_right)]
    shift = median_filter(ends[0] - ends[1], size=(min(ROWS, len(rows)), 1), mode="nearest")
    left, right = ends[0].T
    x = np.arange(inside.shape[1])
    part = np.clip((x - left[:, None]) / np.maximum(right - left, 1)[:, None], 0, 1)
    found = shift[:, :1] * (1 - part) + shift[:, 1:] * part
    nearest = np.abs(np.arange(len(inside))[:, None] - rows).argmin(axis=1)
    return np.ascontiguousarray(found[nearest], np.float32)


def _ends(mask: Array) -> Array:
    """(N, 2): first and last pixel of each row."""
    first = mask.argmax(axis=1)
    return np.stack([first, mask.shape[1] - 1 - mask[:, ::-1].argmax(axis=1)], axis=1).astype(float)
