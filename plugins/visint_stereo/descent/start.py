"""Where the descent starts: from given fields, however incomplete, or from nothing."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array

__all__ = ["complete", "left_from_right", "right_from_left", "shift_between"]

COLUMNS = 128
"""Width of the images on which the first shift is sought."""
HOME = 0.2
"""What a shift by the whole width has to gain, of the usual cost: repeated patterns match nearby."""


def shift_between(left: Array, right: Array) -> float:
    """The one disparity, px, that brings two images (H, W) together best.

    Minimises the absolute difference of median-free images of equal spread, what finds no partner counting by
    its distance from the median: an object before an even background is found wherever it lies, with up to two
    thirds of the width to go. Among shifts that do about as well the smaller wins.
    """
    import cv2

    rows, columns = left.shape
    scale = max(1.0, columns / COLUMNS)
    size = (max(1, round(columns / scale)), max(1, round(rows / scale)))
    small = [cv2.resize(view, size, interpolation=cv2.INTER_AREA) for view in (left, right)]
    here, there = (_levelled(view) for view in small)
    reach = 2 * size[0] // 3
    shifts = np.arange(-reach, reach + 1)
    costs = np.array([_cost_of(here, there, int(shift)) for shift in shifts])
    best = int(np.argmin(costs + HOME * np.median(costs) * np.abs(shifts) / size[0]))
    return float(shifts[best] * columns / size[0])


def _levelled(view: Array) -> Array:
    centred = view - np.median(view)
    return np.asarray(centred / max(float(centred.std()), 1e-6))


def _cost_of(here: Array, there: Array, shift: int) -> float:
    columns = here.shape[1]
    mine = slice(max(0, shift), min(columns, columns + shift))
    theirs = slice(mine.start - shift, mine.stop - shift)
    both = 2 * np.abs(here[:, mine] - there[:, theirs]).sum()
    alone = [np.abs(view).sum() - np.abs(view[:, part]).sum() for view, part in ((here, mine), (there, theirs))]
    return float(both + sum(alone))


def complete(field: Array) -> Array:
    """``field`` float32 (H, W) without NaN: unknown pixels take the nearest known value; 0 if none is known."""
    from scipy.ndimage import distance_transform_edt

    unknown = ~np.isfinite(field)
    if not unknown.any():
        return field
    if unknown.all():
        return np.zeros_like(field)
    nearest = distance_transform_edt(unknown, return_distances=False, return_indices=True)
    return np.ascontiguousarray(field[tuple(nearest)])


def right_from_left(left: Array) -> Array:
    """The right view's disparity that a left field (H, W) implies."""
    from visint_stereo.descent import _kernels

    right = np.empty_like(left)
    _kernels.seen_from_the_right(left, right)
    return complete(right)


def left_from_right(right: Array) -> Array:
    """The left view's disparity that a right field (H, W) implies: the same, seen in a mirror."""
    return np.ascontiguousarray(right_from_left(np.ascontiguousarray(right[:, ::-1]))[:, ::-1])
