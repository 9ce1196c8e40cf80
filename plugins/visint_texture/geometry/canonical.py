"""Canonical moments: the largest and the smallest along any direction, and the direction of the largest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from visint.arrays import Array

__all__ = ["Canonical", "canonical"]


class Canonical(NamedTuple):
    """``largest`` M, ``smallest`` m and ``orientation`` θ of M in (−π/2, π/2], each (…)."""

    largest: Array
    smallest: Array
    orientation: Array


def canonical(moments: Array) -> Canonical:
    """Canonical moments of (g_x, g_xy, g_y) with g_xy = 2E[u_x u_y], shape (…, 3).

    Eqs. 5.87 and 5.88 in the order in which they hold: M, m = ½(g_x + g_y ± √(g_xy² + (g_x − g_y)²)) and
    θ = ½ atan2(g_xy, g_x − g_y).
    """
    x, xy, y = np.moveaxis(moments, -1, 0)
    spread = np.hypot(xy, x - y)
    largest = (x + y + spread) / 2
    # m = det / M loses no digits where m is small.
    with np.errstate(divide="ignore", invalid="ignore"):
        smallest = np.where(largest > 0, (x * y - xy * xy / 4) / largest, 0)
    return Canonical(largest, np.maximum(smallest, 0), np.arctan2(xy, x - y) / 2)
