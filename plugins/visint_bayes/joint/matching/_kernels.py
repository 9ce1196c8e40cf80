# mypy: ignore-errors

"""Kernels of the second view: an image through a disparity, and what a disparity leaves of the other view."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def warp(image, field, sign, value, change):
    """``image`` at x + sign · field by cubic interpolation, and its derivative by the field; NaN outside."""
    rows, columns = field.shape
    last = columns - 1
    for y in range(rows):
        for x in range(columns):
            place = x + sign * field[y, x]
            if not (place >= 0 and place <= last):
                value[y, x] = change[y, x] = np.nan
                continue
            i = int(place)
            t = place - i
            a, b = image[y, max(i - 1, 0)], image[y, i]
            c, d = image[y, min(i + 1, last)], image[y, min(i + 2, last)]
            c1 = 0.5 * (c - a)
            c2 = a - 2.5 * b + 2 * c - 0.5 * d
            c3 = 0.5 * (d - a) + 1.5 * (b - c)
            value[y, x] = b + t * (c1 + t * (c2 + t * c3))
            change[y, x] = sign * (c1 + t * (2 * c2 + 3 * t * c3))


@njit(cache=True, nogil=True)
def nearest_there(field, mask, out):
    """The right view's disparity that a left ``field`` implies inside ``mask``: the nearest surface wins.

    Neighbours less than two pixels apart there are joined; what no pixel reaches is NaN.
    """
    rows, columns = field.shape
    for y in range(rows):
        for x in range(columns):
            out[y, x] = np.nan
        for x in range(columns):
            if not mask[y, x]:
                continue
            for step in range(2):
                value = field[y, x]
                place = x - value
                if step == 1:
                    if x + 1 == columns or not mask[y, x + 1] or not abs(field[y, x + 1] - value) < 1:
                        continue
                    value = 0.5 * (value + field[y, x + 1])
                    place = x + 0.5 - value
                i = int(np.floor(place + 0.5))
                if 0 <= i < columns and not out[y, i] >= value:
                    out[y, i] = value
