"""Heights from singular points outwards, at least cost."""

from __future__ import annotations

import numpy as np

from visint.arrays import Array
from visint_shading.heights.singular import Singular

__all__ = ["propagated"]

FAR = 1e30
ROUNDS = 12
ENOUGH = 3e-5
"""Of ln Z: later rounds that better no height by more are not worth their time."""


def propagated(conic: Array, labels: Array, singular: Singular) -> Array:
    """ln Z − w₀, float64 (H, W), from the groups that are convex or concave; NaN where none leads.

    From convex points heights (depths) grow, from concave ones they fall; where both lead to a pixel the
    cheaper way counts, and their heights are tied by what is known at the points themselves.
    """
    from visint_shading.heights import _kernels

    seeds = singular.bend[singular.group].astype(np.int8)
    base = _bases(singular, int(labels.max(initial=0)) + 1)
    start = np.abs(singular.height - base[singular.bend, singular.label])
    cost = np.where(seeds != 0, start[singular.group], FAR)
    sign = seeds.copy()
    _kernels.heights(conic, labels, seeds, ENOUGH, ROUNDS, cost, sign)
    reached = (sign != 0) & (labels > 0)
    return np.where(reached, base[sign, labels] + sign * cost, np.nan)


def _bases(singular: Singular, count: int) -> Array:
    """float64 (3, N): by bend (1 convex, −1 concave) and region, the height at which cost is 0."""
    base = np.zeros((3, count))
    for bend, pick in ((1, np.minimum), (-1, np.maximum)):
        chosen = singular.bend == bend
        chosen[0] = False
        extreme = np.full(count, bend * np.inf)
        pick.at(extreme, singular.label[chosen], singular.height[chosen])
        base[bend] = np.where(np.isfinite(extreme), extreme, 0)
    return base
